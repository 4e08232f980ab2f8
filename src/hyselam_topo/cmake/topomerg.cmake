# Names from a description for the places of a map (hyselam_topomerg). Sees no ROS header.
add_library(hyselam_topomerg
  src/topomerg/assignment_bound.cpp
  src/topomerg/exact_bound.cpp
  src/topomerg/exact_groups.cpp
  src/topomerg/exact_growth.cpp
  src/topomerg/exact_losses.cpp
  src/topomerg/exact_run.cpp
  src/topomerg/exact_search.cpp
  src/topomerg/exact_sets.cpp
  src/topomerg/explorer.cpp
  src/topomerg/improve.cpp
  src/topomerg/match_problem.cpp
  src/topomerg/merge_terms.cpp
  src/topomerg/names.cpp
  src/topomerg/solutions.cpp
  src/topomerg/tree_search.cpp)
target_link_libraries(hyselam_topomerg PUBLIC hyselam_language)
hyselam_target(hyselam_topomerg)
# The solver's many small functions may be inlined although the library is position independent.
target_compile_options(hyselam_topomerg PRIVATE -fno-semantic-interposition)
install(TARGETS hyselam_topomerg
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})

# ---- tool, benchmark, tests
add_executable(${PROJECT_NAME}_topomerg src/tools/topomerg.cpp)
set_target_properties(${PROJECT_NAME}_topomerg PROPERTIES OUTPUT_NAME topomerg)
target_link_libraries(${PROJECT_NAME}_topomerg hyselam_topomerg)
hyselam_target(${PROJECT_NAME}_topomerg)
install(TARGETS ${PROJECT_NAME}_topomerg RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
hyselam_benchmark(topomerg_benchmark bench/topomerg_benchmark.cpp
                  LIBRARIES hyselam_topomerg)
if(TARGET ${PROJECT_NAME}_topomerg_benchmark)
  target_compile_definitions(${PROJECT_NAME}_topomerg_benchmark
                             PRIVATE HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
endif()

if(CATKIN_ENABLE_TESTING)
  foreach(test topomerg topomerg_bounds topomerg_tool)
    hyselam_gtest(${PROJECT_NAME}_test_${test} test/test_${test}.cpp LIBRARIES hyselam_topomerg)
    if(TARGET ${PROJECT_NAME}_test_${test})
      target_compile_definitions(${PROJECT_NAME}_test_${test}
        PRIVATE HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                HYSELAM_TOPO_TOOLS="${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}")
    endif()
  endforeach()
  if(TARGET ${PROJECT_NAME}_test_topomerg_tool)
    add_dependencies(${PROJECT_NAME}_test_topomerg_tool ${PROJECT_NAME}_topomerg)
  endif()
endif()

# Floors from the plan to the names, for bench/merge.
if(hyselam_sim_FOUND)
  hyselam_bench_program(merge_floors bench/merge_floors.cpp
                        LIBRARIES hyselam_topomerg hyselam_gr2to ${hyselam_sim_LIBRARIES})
endif()
