"""What a Debian package of a catkin package says of itself: its name, version, dependencies, control file, changelog, copyright and man pages.

Nothing here reads the system or the build: what is installed where is asked through a function, so that tests can answer.
"""
import re
import textwrap

# Keys of rosdep in our package.xml files that are no packages of ROS: the names of Debian, as scripts/deps has them.
ROSDEP = {"cli11": "libcli11-dev", "eigen": "libeigen3-dev", "libpcl-all-dev": "libpcl-dev", "nlohmann-json-dev": "nlohmann-json3-dev",
          "suitesparse": "libsuitesparse-dev", "tinyxml2": "libtinyxml2-dev", "yaml-cpp": "libyaml-cpp-dev", "zlib": "zlib1g-dev"}
PART_OF = "This package is part of HySeLAM, which gives a mobile robot with ROS a map that people can talk about."
# What programs of people are started by: rosrun, as their man pages say.
STARTERS = ("rosbash", "rospack-tools")
# What the package does without, though its package.xml has it: a robot without a screen, or without some layers, leaves it out by
# --no-install-recommends; a launch file of a layer that is not there says so.
RECOMMENDED = {"hyselam_bringup": ("hyselam_rviz_plugins", "rviz", "selovis", "hyselam_objects", "hyselam_web")}
# What goes with a library that its own are linked with: the icons of a rviz of Qt 6 are drawn by a plugin that rviz itself does not ask for.
WITH_LIBRARY = {"hyselam_rviz_plugins": {"libqt6widgets6": ("qt6-svg-plugins",)}}
# What people who look at a running stack call, and the tutorials do.
OPERATORS = {"hyselam_bringup": ("python3-rosnode", "python3-rosservice", "python3-rostopic")}
# What its scripts call where it is installed, and say where it is not.
SUGGESTED = {"hyselam_topo": ("espeak-ng", "pocketsphinx", "pocketsphinx-en-us"), "ngram_slam": ("python3-distributed",)}
# What lintian finds and is as we want it: the tag, the kind of package that has it (one that holds a "library", one that is
# "without-libc", a file for "pkg-config"), the reason.
OVERRIDES = (
    ("shared-library-lacks-version", "library", "the packages depend on one another by exact versions, the libraries have none of their own"),
    ("package-name-doesnt-match-sonames", "library", "a package is what a catkin package installs: libraries beside programs and launch files"),
    ("library-not-linked-against-libc", "without-libc", "a small library that calls only others, which are linked with the C library"),
    ("pkg-config-unavailable-for-cross-compilation", "pkg-config", "catkin writes lib/pkgconfig, and rospack and catkin_make are not for cross-compilation"),
)


def os_release(text):
    """The fields of /etc/os-release."""
    return dict(re.findall(r'^(\w+)="?([^"\n]*)"?$', text, re.MULTILINE))


def debian_name(package):
    """Of a catkin package, as Debian names those of ROS."""
    return "ros-" + package.replace("_", "-")


def debian_version(version, release, commit_time="", modified=False, before_release=False):
    """Of the version of package.xml on a release such as debian12; between tags (the time of a commit is given) newer commits have higher ones.

    `before_release`: the version has no tag yet: those of now sort below the release.

    No longer than file names may be; the commit is told by changelog(). What was packed from a modified tree has an m behind the time.
    """
    between = f"{'~' if before_release else '+'}{commit_time}{'m' if modified else ''}" if commit_time else ""
    return f"{version}{between}-1~{release}"


def owned(owner, *paths):
    """The packages that own one of the paths, without repetition."""
    return sorted({p for p in map(owner, paths) if p})


def names_of(key, owner, python):
    """The Debian packages behind a key of package.xml, (needed to run, wanted to compile against it).

    `owner` tells the installed package that owns a path, None if nobody does. What a C++ library needs is told by dpkg-shlibdeps and left out
    here: of a package of ROS these are its programs, its Python module if `python`, and what else of it is no -dev package.
    """
    if key in ROSDEP or key.startswith("python3-"):
        names = [ROSDEP.get(key, key)]
    else:
        names = owned(owner, f"/usr/lib/{key}", *([f"/usr/lib/python3/dist-packages/{key}/__init__.py"] if python else []))
        share = owned(owner, f"/usr/share/{key}/package.xml")
        names += [n for n in share if n.endswith("-dev") or not names]
        names = names or owned(owner, f"/usr/share/doc/{key}/copyright")
    return [n for n in names if not n.endswith("-dev")], [n for n in names if n.endswith("-dev")]


def relations(package, packed, owner, python):
    """Depends, Recommends and Suggests that package.xml tells of, without those of libraries.

    `package` is a package of catkin_pkg; `packed` maps the packages that are packed with it to their versions. Between these the versions are
    exact: their libraries have no version of their own. @raises KeyError for a key that nothing installed answers to.
    """
    depends, recommends, suggests = set(), set(OPERATORS.get(package.name, ())), set(SUGGESTED.get(package.name, ()))
    wanted = {d.name: True for d in package.exec_depends}
    wanted = {**{d.name: False for d in package.build_export_depends}, **wanted}
    for key, runs in wanted.items():
        target = recommends if key in RECOMMENDED.get(package.name, ()) else depends
        if key in packed:
            target.add(f"{debian_name(key)} (= {packed[key]})")
            continue
        needed, development = names_of(key, owner, python)
        if not needed and not development:
            raise KeyError(f"{package.name}: no installed package is known that holds {key}")
        if runs:
            target.update(needed)
        suggests.update(development)
    return {"Depends": sorted(depends), "Recommends": sorted(recommends), "Suggests": sorted(suggests)}


def recommended_with(package, depends):
    """What is recommended since one of the libraries in `depends`, entries of dpkg-shlibdeps such as "libc6 (>= 2.36)", is linked."""
    linked = {re.split(r"[ (|]", d)[0] for d in depends}
    return sorted({name for library, names in WITH_LIBRARY.get(package, {}).items() if library in linked for name in names})


def plugin_description(text):
    """Of pluginlib, as it is to be in /usr, and the libraries it names.

    Where CMAKE_PREFIX_PATH is not set, Debian's pluginlib looks for a library by its bare name in /usr/lib/ARCHITECTURE/ros.
    """
    pattern = r'(<library\s[^>]*path=")lib/(lib[A-Za-z0-9_]+)"'
    return re.sub(pattern, r'\1\2"', text), [name for _, name in re.findall(pattern, text)]


def synopsis(description):
    """The line that lists of packages show: the first sentence; of a long one what its colon ends, or its first clauses, or words."""
    first = re.split(r"(?<=[a-z)])[.;](?:\s|$)", " ".join(description.split()))[0].rstrip(".")
    first = re.sub(r"^(The|A|An) ", "", first)
    if len(first) <= 78:
        return first
    ends = [m.start() for pattern in (r"[:,]\s", r":\s") for m in re.finditer(pattern, first) if (20 if "," in pattern else 36) <= m.start() <= 78]
    return first[:ends[-1]] if ends else re.sub(r"( (a|an|the|and|of|in|with|by))+$", "", textwrap.shorten(first, 78, placeholder=""))


def control(fields, description):
    """The control file: fields without a value are left out."""
    lines = [f"{k}: {', '.join(v) if isinstance(v, list) else v}" for k, v in fields.items() if v]
    text = textwrap.wrap(f"{PART_OF} {' '.join(description.split())}", 78)
    return "\n".join([*lines, f"Description: {synopsis(description)}", *(" " + line for line in text)]) + "\n"


def changelog(name, version, suite, maintainer, date, commit):
    return (f"{name} ({version}) {suite}; urgency=medium\n\n  * Packed from the sources at commit {commit}; what changed is in changelog.gz.\n\n"
            f" -- {maintainer}  {date}\n")


def copyright_file(package, maintainer, license_text):
    """In Debian's machine-readable form, of the text of LICENSE (3-clause BSD)."""
    holder = re.search(r"^Copyright \(c\) (.*)$", license_text, re.MULTILINE).group(1)
    text = license_text.split(holder, 1)[1].strip()
    body = "\n".join(" " + (line.rstrip() or ".") for line in text.splitlines())
    return ("Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n"
            f"Upstream-Name: {package}\nUpstream-Contact: {maintainer}\n\nFiles: *\nCopyright: {holder}\nLicense: BSD-3-clause\n{body}\n")


def purpose(text, package):
    """One line of what a program is for, of its --help: the first paragraph that is no usage."""
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        line = " ".join(paragraph.split())
        if line and not re.match(r"(usage|options|positionals|optional arguments|positional arguments|subcommands)\b", line, re.IGNORECASE):
            return textwrap.shorten(re.split(r"[.:](?:\s|$)", line)[0], 90, placeholder=" …")
    return f"a program of {package}"


def man_page(package, tool, text, version, date):
    """A page of section 1, of what `TOOL --help` prints."""
    def escaped(line):
        line = line.rstrip().replace("\\", "\\e").replace("-", "\\-")
        return "\\&" + line if line.startswith((".", "'")) else line

    name = f"{package}-{tool}"
    return "\n".join([f'.TH {escaped(name.upper())} 1 "{date}" "HySeLAM {version}" "HySeLAM"', ".SH NAME",
                      f"{escaped(name)} \\- {escaped(purpose(text, package))}", ".SH SYNOPSIS", f".B rosrun {escaped(package)} {escaped(tool)}",
                      "[options]", ".SH DESCRIPTION", ".nf", *map(escaped, text.strip().splitlines()), ".fi"]) + "\n"


def overrides(name, kinds):
    """The file of overrides for lintian, "" if there are none."""
    return "".join(f"# {reason}\n{name}: {tag}\n" for tag, kind, reason in OVERRIDES if kind in kinds)


def maintainer_scripts(name, python, units, state):
    """postinst, prerm and postrm as texts, those that have something to do. `units` are templates of systemd, `state` folders gone with a purge."""
    post, pre, rm = [], [], []
    if python:
        # Without it, modules that root imports would leave __pycache__ behind.
        post.append(f'if [ "$1" = configure ] && command -v py3compile > /dev/null; then py3compile -p {name}; fi')
        pre.append(f"if command -v py3clean > /dev/null; then py3clean -p {name}; fi")
    if units:
        running = "[ -d /run/systemd/system ]"
        post.append(f"if {running}; then systemctl daemon-reload || true; fi")
        for unit in units:
            pre.append(f"if [ \"$1\" = remove ] && {running}; then systemctl stop '{unit.replace('@', '@*')}' || true; fi")
            rm.append(f"if [ \"$1\" = purge ]; then rm -f /etc/systemd/system/*.wants/{unit.replace('@', '@*')}; fi")
        rm.append(f"if {running}; then systemctl daemon-reload || true; fi")
    if state:
        rm.append(f"if [ \"$1\" = purge ]; then rm -rf {' '.join(state)}; fi")
    scripts = {"postinst": post, "prerm": pre, "postrm": rm}
    return {k: "\n".join(["#!/bin/sh", "set -e", *v]) + "\n" for k, v in scripts.items() if v}
