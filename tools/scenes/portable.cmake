# Scenes for processors that only a cross compiler knows. The kernel and what makes scenes are compiled as they are; of
# other libraries this takes headers alone.
#
# Beside nlohmann's headers stand those of the machine that compiles, which are not for the one that is compiled for.
find_path(PLUMB_JSON_HEADERS nlohmann/json.hpp REQUIRED PATHS /usr/include NO_CMAKE_FIND_ROOT_PATH)
set(json ${CMAKE_CURRENT_BINARY_DIR}/portable_include)
file(MAKE_DIRECTORY ${json})
file(CREATE_LINK ${PLUMB_JSON_HEADERS}/nlohmann ${json}/nlohmann SYMBOLIC)
add_library(plumb_portable_json INTERFACE)
target_include_directories(plumb_portable_json SYSTEM INTERFACE ${json})

set(sources ${CMAKE_CURRENT_LIST_DIR}/spec.cpp)
foreach(room basics files generators humanoid shots)
  file(GLOB of_room CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/${room}/*.cpp)
  set_source_files_properties(${of_room} PROPERTIES UNITY_GROUP ${room})
  list(APPEND sources ${of_room})
endforeach()
add_library(plumb_portable_scenes STATIC ${sources})
set_target_properties(plumb_portable_scenes PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
target_include_directories(plumb_portable_scenes PUBLIC ${CMAKE_CURRENT_LIST_DIR}/..)
target_compile_options(plumb_portable_scenes PRIVATE $<$<CONFIG:Release>:-O1>)
target_link_libraries(plumb_portable_scenes PUBLIC plumb::plumb plumb::layouts plumb::reference
                                            PRIVATE plumb_portable_json plumb_options)
