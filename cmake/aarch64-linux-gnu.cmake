# For scripts/cross_arm64: arm64 programs made on amd64, on a Debian whose arm64 libraries lie beside the own ones (multiarch):
# in /usr/lib/aarch64-linux-gnu, where the cross compiler looks by itself, with headers that both share. So there is no sysroot, and
# the absolute paths that catkin's packages name hold as they are.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
# Nothing of the building machine is linked, whatever is missing.
set(CMAKE_IGNORE_PATH /usr/lib/x86_64-linux-gnu /usr/lib/x86_64-linux-gnu/cmake /lib/x86_64-linux-gnu)
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
# Programs that are made to be run by the build.
set(CMAKE_CROSSCOMPILING_EMULATOR /usr/bin/qemu-aarch64-static)
