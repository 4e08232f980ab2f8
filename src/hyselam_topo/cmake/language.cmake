# What people say (hyselam_language): descriptions of buildings. Sees no ROS header, no grid map.
add_library(hyselam_language
  src/language/described_building.cpp)
target_link_libraries(hyselam_language PUBLIC hyselam_topo)
hyselam_target(hyselam_language)
install(TARGETS hyselam_language
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
