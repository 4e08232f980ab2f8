# Names from a description for the places of a map (hyselam_topomerg). Sees no ROS header.
add_library(hyselam_topomerg
  src/topomerg/assignment_bound.cpp
  src/topomerg/exact_bound.cpp
  src/topomerg/exact_search.cpp
  src/topomerg/explorer.cpp
  src/topomerg/improve.cpp
  src/topomerg/match_problem.cpp
  src/topomerg/merge_terms.cpp
  src/topomerg/names.cpp
  src/topomerg/solutions.cpp
  src/topomerg/tree_search.cpp)
target_link_libraries(hyselam_topomerg PUBLIC hyselam_language)
hyselam_target(hyselam_topomerg)
install(TARGETS hyselam_topomerg
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})

add_executable(${PROJECT_NAME}_topomerg src/tools/topomerg.cpp)
set_target_properties(${PROJECT_NAME}_topomerg PROPERTIES OUTPUT_NAME topomerg)
target_link_libraries(${PROJECT_NAME}_topomerg hyselam_topomerg)
hyselam_target(${PROJECT_NAME}_topomerg)
install(TARGETS ${PROJECT_NAME}_topomerg RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
