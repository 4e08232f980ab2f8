# What people say (hyselam_language): descriptions of buildings. Sees no ROS header, no grid map.
find_package(yaml-cpp REQUIRED)

# The grammars are data; the library carries the shipped ones, so that it needs no path to them.
set(HYSELAM_SHIPPED_GRAMMARS "")
foreach(language en pt)
  set(grammar_file ${PROJECT_SOURCE_DIR}/grammar/${language}.yaml)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${grammar_file})
  file(READ ${grammar_file} grammar_text)
  # A literal may not be too long for all compilers: in pieces of at most 8000 characters.
  string(LENGTH "${grammar_text}" grammar_length)
  set(grammar_literal "")
  set(grammar_at 0)
  while(grammar_at LESS grammar_length)
    string(SUBSTRING "${grammar_text}" ${grammar_at} 8000 grammar_piece)
    string(APPEND grammar_literal "\n     R\"grammar(${grammar_piece})grammar\"")
    math(EXPR grammar_at "${grammar_at} + 8000")
  endwhile()
  string(APPEND HYSELAM_SHIPPED_GRAMMARS "    {\"${language}\",${grammar_literal}},\n")
endforeach()
set(HYSELAM_LANGUAGE_GENERATED ${PROJECT_BINARY_DIR}/language)
configure_file(src/language/shipped_grammars.hpp.in
               ${HYSELAM_LANGUAGE_GENERATED}/shipped_grammars.hpp @ONLY)

set(HYSELAM_LANGUAGE_SOURCES
  src/language/capture.cpp
  src/language/clause_borders.cpp
  src/language/compiled_grammar.cpp
  src/language/describe_building.cpp
  src/language/described_building.cpp
  src/language/description_builder.cpp
  src/language/description_xml.cpp
  src/language/edit_description.cpp
  src/language/grammar.cpp
  src/language/grammar_node.cpp
  src/language/grammar_reader.cpp
  src/language/intent_reader.cpp
  src/language/letters.cpp
  src/language/matcher.cpp
  src/language/measure_reader.cpp
  src/language/measures.cpp
  src/language/name_finder.cpp
  src/language/name_type_reader.cpp
  src/language/pattern.cpp
  src/language/pattern_run.cpp
  src/language/place_names.cpp
  src/language/refusal.cpp
  src/language/sentence_words.cpp
  src/language/tokens.cpp
  src/language/told_connections.cpp
  src/language/told_places.cpp
  src/language/topo_parser.cpp
  src/language/utterance.cpp
  src/language/word_lists.cpp)
add_library(hyselam_language ${HYSELAM_LANGUAGE_SOURCES})
#catkin_lint: ignore_once missing_directory
target_include_directories(hyselam_language PRIVATE src/core ${HYSELAM_LANGUAGE_GENERATED})
target_include_directories(hyselam_language SYSTEM PRIVATE ${TINYXML2_INCLUDE_DIR}
                                                           ${YAML_CPP_INCLUDE_DIR})
target_link_libraries(hyselam_language PUBLIC hyselam_topo
                                       PRIVATE ${TINYXML2_LIBRARY} ${YAML_CPP_LIBRARIES})
hyselam_target(hyselam_language)
install(TARGETS hyselam_language
  ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION}
  RUNTIME DESTINATION ${CATKIN_GLOBAL_BIN_DESTINATION})
install(DIRECTORY grammar DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

add_executable(${PROJECT_NAME}_parse_description src/tools/parse_description.cpp)
set_target_properties(${PROJECT_NAME}_parse_description PROPERTIES OUTPUT_NAME parse_description)
target_link_libraries(${PROJECT_NAME}_parse_description hyselam_language)
hyselam_target(${PROJECT_NAME}_parse_description)
install(TARGETS ${PROJECT_NAME}_parse_description
        RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})

hyselam_benchmark(topo_parser_benchmark bench/language_benchmark.cpp
                  LIBRARIES hyselam_language)

if(CATKIN_ENABLE_TESTING)
  hyselam_gtest(${PROJECT_NAME}_test_description_xml test/test_description_xml.cpp
                LIBRARIES hyselam_language)
  hyselam_gtest(${PROJECT_NAME}_test_language test/test_language.cpp
                LIBRARIES hyselam_language)
  hyselam_gtest(${PROJECT_NAME}_test_language_corpus test/test_language_corpus.cpp
                LIBRARIES hyselam_language ${YAML_CPP_LIBRARIES})
  foreach(test description_xml language language_corpus)
    if(TARGET ${PROJECT_NAME}_test_${test})
      target_compile_definitions(${PROJECT_NAME}_test_${test} PRIVATE
        HYSELAM_TOPO_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
        HYSELAM_TOPO_TOOLS="${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}")
    endif()
  endforeach()
  if(TARGET ${PROJECT_NAME}_test_language)
    add_dependencies(${PROJECT_NAME}_test_language ${PROJECT_NAME}_parse_description)
  endif()
endif()
