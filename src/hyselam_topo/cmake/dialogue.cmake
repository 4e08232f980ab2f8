# The robot's place, glass walls, names and the talk about them (hyselam_dialogue). Sees no ROS header.

# What the robot says is data; the library carries the shipped phrases, so that it needs no path to them.
set(HYSELAM_SHIPPED_PHRASES "")
foreach(language en pt)
  set(phrases_file ${PROJECT_SOURCE_DIR}/dialogue/${language}.yaml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${phrases_file})
  file(READ ${phrases_file} phrases_text)
  string(APPEND HYSELAM_SHIPPED_PHRASES
         "    {\"${language}\", R\"phrases(${phrases_text})phrases\"},\n")
endforeach()
set(HYSELAM_DIALOGUE_GENERATED ${PROJECT_BINARY_DIR}/dialogue)
configure_file(src/dialogue/shipped_phrases.hpp.in
               ${HYSELAM_DIALOGUE_GENERATED}/shipped_phrases.hpp @ONLY)

add_library(hyselam_dialogue
  src/dialogue/dialogue.cpp
  src/dialogue/dialogue_answers.cpp
  src/dialogue/dialogue_descriptions.cpp
  src/dialogue/dialogue_naming.cpp
  src/dialogue/dialogue_questions.cpp
  src/dialogue/dialogue_state.cpp
  src/dialogue/dialogue_walls.cpp
  src/dialogue/glass_wall.cpp
  src/dialogue/match_constraints.cpp
  src/dialogue/phrases.cpp
  src/dialogue/place_man.cpp
  src/dialogue/place_pose.cpp
  src/dialogue/route.cpp
  src/dialogue/topo_state.cpp)
#catkin_lint: ignore_once missing_directory
target_include_directories(hyselam_dialogue PRIVATE src/core ${HYSELAM_DIALOGUE_GENERATED})
target_include_directories(hyselam_dialogue SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS}
                                                           ${YAML_CPP_INCLUDE_DIR})
target_link_libraries(hyselam_dialogue PUBLIC hyselam_topomerg
                                       PRIVATE opencv_core opencv_imgproc ${YAML_CPP_LIBRARIES})
hyselam_target(hyselam_dialogue)
install(TARGETS hyselam_dialogue
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY dialogue DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# ---- ROS face: nodelet TopoEngine, console chat ------------------------------------------------------
# Driving by the action move_base, where its messages are.
find_package(actionlib QUIET)
find_package(move_base_msgs QUIET)
add_library(hyselam_topo_engine
  src/ros/dialogue_markers.cpp
  src/ros/goal_driver.cpp
  src/ros/object_talk.cpp
  src/ros/topo_engine_parameters.cpp
  src/ros/topo_engine_server.cpp
  src/ros/topo_engine_services.cpp)
target_link_libraries(hyselam_topo_engine PUBLIC hyselam_dialogue hyselam_topo_ros)
if(actionlib_FOUND AND move_base_msgs_FOUND)
  target_compile_definitions(hyselam_topo_engine PRIVATE HYSELAM_HAVE_MOVE_BASE)
  target_include_directories(hyselam_topo_engine SYSTEM PRIVATE ${actionlib_INCLUDE_DIRS}
                                                                ${move_base_msgs_INCLUDE_DIRS})
  target_link_libraries(hyselam_topo_engine PRIVATE ${actionlib_LIBRARIES})
else()
  message(STATUS "${PROJECT_NAME}: actionlib or move_base_msgs not found, ways are published only")
endif()
add_dependencies(hyselam_topo_engine ${catkin_EXPORTED_TARGETS})
hyselam_target(hyselam_topo_engine)
target_sources(hyselam_topo_nodelets PRIVATE src/nodelets/topo_engine_nodelet.cpp)
target_link_libraries(hyselam_topo_nodelets hyselam_topo_engine)
install(TARGETS hyselam_topo_engine
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
catkin_install_python(PROGRAMS scripts/chat scripts/listen scripts/speak
                      DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

if(CATKIN_ENABLE_TESTING)
  hyselam_fuzz_seeds(LIBRARIES hyselam_dialogue)
  foreach(test topo_state glass_wall place_man route)
    hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp LIBRARIES hyselam_dialogue)
  endforeach()
  if(hyselam_sim_FOUND)
    hyselam_gtest(${PROJECT_NAME}_test_dialogue test/test_dialogue.cpp
                  LIBRARIES hyselam_dialogue hyselam_gr2to ${hyselam_sim_LIBRARIES})
    if(TARGET ${PROJECT_NAME}_test_dialogue)
      target_compile_definitions(${PROJECT_NAME}_test_dialogue
                                 PRIVATE HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
    foreach(test dialogue_floors told_buildings)
      hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp
                    LIBRARIES hyselam_dialogue hyselam_gr2to ${hyselam_sim_LIBRARIES})
    endforeach()
    if(TARGET ${PROJECT_NAME}_test_told_buildings)
      target_compile_definitions(${PROJECT_NAME}_test_told_buildings
                                 PRIVATE HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
  endif()
endif()
