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
  src/dialogue/dialogue_naming.cpp
  src/dialogue/dialogue_state.cpp
  src/dialogue/dialogue_walls.cpp
  src/dialogue/glass_wall.cpp
  src/dialogue/phrases.cpp
  src/dialogue/place_man.cpp
  src/dialogue/place_pose.cpp
  src/dialogue/route.cpp
  src/dialogue/topo_state.cpp)
target_include_directories(hyselam_dialogue PRIVATE src/core ${HYSELAM_DIALOGUE_GENERATED})
target_include_directories(hyselam_dialogue SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS}
                                                           ${YAML_CPP_INCLUDE_DIR})
target_link_libraries(hyselam_dialogue PUBLIC hyselam_topomerg
                                       PRIVATE opencv_core opencv_imgproc ${YAML_CPP_LIBRARIES}
                                               ZLIB::ZLIB)
hyselam_target(hyselam_dialogue)
install(TARGETS hyselam_dialogue
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY dialogue DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

if(CATKIN_ENABLE_TESTING)
  foreach(test topo_state glass_wall place_man route)
    hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp LIBRARIES hyselam_dialogue)
  endforeach()
endif()
