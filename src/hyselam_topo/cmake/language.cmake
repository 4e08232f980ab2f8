# What people say (hyselam_language): descriptions of buildings. Sees no ROS header, no grid map.
add_library(hyselam_language
  src/language/described_building.cpp
  src/language/description_xml.cpp)
target_include_directories(hyselam_language PRIVATE src/core)
target_include_directories(hyselam_language SYSTEM PRIVATE ${TINYXML2_INCLUDE_DIR})
target_link_libraries(hyselam_language PUBLIC hyselam_topo PRIVATE ${TINYXML2_LIBRARY})
hyselam_target(hyselam_language)
install(TARGETS hyselam_language
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})

if(CATKIN_ENABLE_TESTING)
  foreach(test description_xml)
    hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp LIBRARIES hyselam_language)
    if(TARGET ${PROJECT_NAME}_test_${test})
      target_compile_definitions(${PROJECT_NAME}_test_${test}
                                 PRIVATE HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    endif()
  endforeach()
endif()
