# OpenVDB ships its find module beside its libraries and not where CMake looks. A function, because the module sets
# BUILD_SHARED_LIBS for whoever calls it, and because it, and the Imath that it looks for, print notes that mean nothing
# to a user.
function(mallow_find_openvdb)
  find_path(MALLOW_OPENVDB_MODULE FindOpenVDB.cmake
    PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB lib/cmake/OpenVDB lib64/cmake/OpenVDB)
  mark_as_advanced(MALLOW_OPENVDB_MODULE)
  if(MALLOW_OPENVDB_MODULE)
    list(APPEND CMAKE_MODULE_PATH ${MALLOW_OPENVDB_MODULE})
  endif()
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(OpenVDB QUIET COMPONENTS openvdb)
endfunction()
mallow_find_openvdb()
