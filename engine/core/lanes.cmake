# mallow_add_lanes(<source> [target]): compiles a file of lanes once per instruction level into a target, mallow if none
# is named; the level is chosen at run time (core/isa.h). On machines other than x86-64 there is one level, the
# compiler's own; fuzz targets, as lanes take minutes to compile, do with that as well.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64" AND NOT MALLOW_FUZZ)
  set(MALLOW_X86_LEVELS ON)
endif()

function(mallow_add_lanes source)
  set(target mallow)
  if(ARGC GREATER 1)
    set(target ${ARGV1})
  endif()
  set(levels baseline)
  if(MALLOW_X86_LEVELS)
    list(APPEND levels v3 v4)
  endif()
  foreach(level ${levels})
    mallow_add_lanes_at(${source} ${target} ${level} level_${level})
  endforeach()
endfunction()

# mallow_add_native_lanes(<source>): once more for Arithmetic::native, at the levels that have fused multiply-adds.
function(mallow_add_native_lanes source)
  if(NOT MALLOW_X86_LEVELS)
    return()
  endif()
  foreach(level v3 v4)
    mallow_add_lanes_at(${source} mallow ${level} level_${level}_native)
    get_filename_component(name ${source} NAME_WE)
    target_compile_definitions(mallow_${name}_${level}_native PRIVATE MALLOW_NATIVE)
    target_link_libraries(mallow_${name}_${level}_native PRIVATE mallow_native_options)
  endforeach()
endfunction()

# mallow_add_lanes_at(<source> <target> <level> <namespace>)
function(mallow_add_lanes_at source target level namespace)
  set(flags_baseline -march=x86-64-v2)
  set(flags_v3 -march=x86-64-v3)
  set(flags_v4 -march=x86-64-v4 -mprefer-vector-width=512)
  if(NOT MALLOW_X86_LEVELS)
    set(flags_baseline)
  endif()
  get_filename_component(name ${source} NAME_WE)
  string(REPLACE level_ mallow_${name}_ object ${namespace})
  add_library(${object} OBJECT ${source})
  target_include_directories(${object} PRIVATE ${MALLOW_INCLUDE_DIR} ${PROJECT_SOURCE_DIR}/engine)
  target_compile_definitions(${object} PRIVATE MALLOW_LEVEL=${namespace} $<$<BOOL:${MALLOW_X86_LEVELS}>:MALLOW_X86_LEVELS>)
  # Vectors wider than a register never leave a file of lanes, so it matters to none how they are passed (-Wno-psabi).
  # Without -fno-math-errno and -fno-trapping-math a square root or a comparison keeps a loop scalar; neither
  # changes a result.
  target_compile_options(${object} PRIVATE ${flags_${level}} -fno-math-errno -fno-trapping-math -Wno-psabi
    $<$<NOT:$<OR:$<CONFIG:Debug>,$<BOOL:${MALLOW_FUZZ}>>>:-O3>)
  target_link_libraries(${object} PRIVATE mallow_build_options Eigen3::Eigen)
  set_target_properties(${object} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON UNITY_BUILD OFF)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${object}>)
endfunction()
