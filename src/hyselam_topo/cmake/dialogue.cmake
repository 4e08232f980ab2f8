# The robot's place, glass walls, names and the talk about them (hyselam_dialogue). Sees no ROS header.
add_library(hyselam_dialogue
  src/dialogue/glass_wall.cpp
  src/dialogue/place_pose.cpp
  src/dialogue/topo_state.cpp)
target_include_directories(hyselam_dialogue SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
target_link_libraries(hyselam_dialogue PUBLIC hyselam_language PRIVATE opencv_core opencv_imgproc)
hyselam_target(hyselam_dialogue)
install(TARGETS hyselam_dialogue
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})

if(CATKIN_ENABLE_TESTING)
  foreach(test topo_state glass_wall)
    hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp LIBRARIES hyselam_dialogue)
  endforeach()
endif()
