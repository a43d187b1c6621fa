# SPDX-License-Identifier: GPL-2.0-or-later
# The plugin and the Python package, included by the top CMakeLists.txt.

# ---------------------------------------------------------------------------------------------------------------------
# What they need. YADE is bound to Debian's Python and Boost, so a second copy of either must not be found first.

if(NOT DEFINED Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python3_EXECUTABLE /usr/bin/python3)
endif()
include(pkg/membrane/yade-abi/release.cmake)
find_package(Python3 ${release_python} EXACT QUIET COMPONENTS Interpreter Development.Module)
membrane_require(Python3_FOUND "Python ${release_python}, the one of YADE ${MEMBRANE_YADE}, with its headers"
                 python3-dev)
find_package(Boost ${release_boost} EXACT QUIET CONFIG)
membrane_require(Boost_FOUND "Boost ${release_boost}, the one of YADE ${MEMBRANE_YADE}," libboost-dev)
find_path(GLUT_INCLUDE_DIR GL/glut.h) # and OpenGL's own, to draw in YADE's 3D view; YADE brings the libraries
membrane_require(GLUT_INCLUDE_DIR "GL/glut.h" libglut-dev)

# ---------------------------------------------------------------------------------------------------------------------
# The plugin: one Python extension module, whose missing symbols the loaded YADE supplies.

file(GLOB_RECURSE plugin_sources CONFIGURE_DEPENDS pkg/membrane/*.cpp)
list(REMOVE_ITEM plugin_sources ${mechanics_sources})
add_library(membrane_plugin OBJECT ${plugin_sources})
target_link_libraries(membrane_plugin PUBLIC membrane_mechanics)
if(MEMBRANE_SANITIZE)
    # Two large files take a third of the time of many.
    set_target_properties(membrane_plugin PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
    target_compile_options(membrane_plugin PRIVATE -O0)
endif()
target_include_directories(membrane_plugin SYSTEM PRIVATE ${Boost_INCLUDE_DIRS} ${Python3_INCLUDE_DIRS}
                           ${GLUT_INCLUDE_DIR})
target_compile_definitions(membrane_plugin PRIVATE MEMBRANE_MODULE) # module.cpp, which a YADE tree leaves out

# The macros that shape YADE's classes, as its package was built.
target_compile_definitions(membrane_plugin PRIVATE YADE_OPENMP YADE_MPI YADE_OPENGL YADE_FEM YADE_REAL_BIT=64
                           YADE_ABI_RELEASE=${release_abi} MEMBRANE_YADE="${MEMBRANE_YADE}")
if(YADE_SOURCE_DIR)
    if(NOT EXISTS ${YADE_SOURCE_DIR}/core/Scene.hpp)
        message(FATAL_ERROR "YADE_SOURCE_DIR=${YADE_SOURCE_DIR} is not a YADE source tree: it has no core/Scene.hpp")
    endif()
    # Open MPI by name: other MPI libraries give Scene another layout.
    find_path(OPENMPI_INCLUDE_DIR mpi.h PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/openmpi/include NO_DEFAULT_PATH)
    membrane_require(OPENMPI_INCLUDE_DIR "Open MPI's mpi.h, which YADE's headers include," libopenmpi-dev)
    target_compile_definitions(membrane_plugin PRIVATE YADE_REAL_DEC=15 YADE_COMPLEX_MP YADE_BOOST_LOG
                               BOOST_LOG_DYN_LINK MAX_LOG_LEVEL=5 OMPI_SKIP_MPICXX)
    target_include_directories(membrane_plugin SYSTEM PRIVATE ${YADE_SOURCE_DIR} ${OPENMPI_INCLUDE_DIR})
else()
    target_include_directories(membrane_plugin PRIVATE pkg/membrane/yade-abi)
endif()

set(python_dir ${PROJECT_BINARY_DIR}/python)
add_library(_membrane MODULE)
target_link_libraries(_membrane PRIVATE membrane_plugin)
# Named after Python's ABI, so that no other Python takes it.
set_target_properties(_membrane PROPERTIES PREFIX "" SUFFIX .${Python3_SOABI}.so
                      LIBRARY_OUTPUT_DIRECTORY ${python_dir}/membrane)

# Symbol check: the same objects linked once with nothing left undefined, under the name that a YADE tree would give
# them. Not installed; a test loads it as YADE loads libraries of its own.
set(lib_dir /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE})
set(python_version ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR})
set(symbol_sources
    ${lib_dir}/yade-double/libyade.so
    ${lib_dir}/yade-double/libpkg_common.so
    ${lib_dir}/yade-double/libpkg_dem.so
    ${lib_dir}/libGL.so.1
    ${lib_dir}/libglut.so
    ${lib_dir}/libpython${python_version}.so.1)
set(boost_libraries python${Python3_VERSION_MAJOR}${Python3_VERSION_MINOR} serialization)
if(YADE_SOURCE_DIR)
    list(APPEND boost_libraries log system thread)
endif()
foreach(name IN LISTS boost_libraries)
    list(APPEND symbol_sources ${lib_dir}/libboost_${name}.so.${Boost_VERSION_STRING})
endforeach()
set(absent "")
foreach(file IN LISTS symbol_sources)
    if(NOT EXISTS ${file})
        list(APPEND absent ${file})
    endif()
endforeach()
if(absent)
    message(STATUS "No symbol check, for want of ${absent} (apt-get install yade)")
else()
    add_library(membrane_symbols SHARED)
    target_link_libraries(membrane_symbols PRIVATE membrane_plugin ${symbol_sources})
    target_link_options(membrane_symbols PRIVATE -Wl,--no-undefined)
    set_target_properties(membrane_symbols PROPERTIES OUTPUT_NAME pkg_membrane
                          LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/symbol-check)
endif()

# ---------------------------------------------------------------------------------------------------------------------
# All sources in one, in either order, as a unity build of a YADE tree puts them together: read only, with the warnings
# that are errors there, and once with all that a tree may lack. A test builds it.

add_library(membrane_unity OBJECT EXCLUDE_FROM_ALL)
target_link_libraries(membrane_unity PRIVATE membrane_mechanics)
target_include_directories(membrane_unity SYSTEM PRIVATE $<TARGET_PROPERTY:membrane_plugin,INCLUDE_DIRECTORIES>)
target_compile_definitions(membrane_unity PRIVATE $<TARGET_PROPERTY:membrane_plugin,COMPILE_DEFINITIONS>)
target_compile_options(membrane_unity PRIVATE -fsyntax-only -UMEMBRANE_MODULE -Wformat-nonliteral -Wfloat-conversion
                       -Wcast-align -Wpointer-arith -Wwrite-strings -Wnon-virtual-dtor -Wsuggest-override
                       -Wswitch-default)
set(unity_sources ${plugin_sources} ${mechanics_sources})
foreach(order ASCENDING DESCENDING)
    list(SORT unity_sources ORDER ${order})
    list(TRANSFORM unity_sources REPLACE ".+" "#include \"\\0\"\n" OUTPUT_VARIABLE includes)
    list(JOIN includes "" includes)
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/unity/${order}.cpp CONTENT "${includes}")
    target_sources(membrane_unity PRIVATE ${PROJECT_BINARY_DIR}/unity/${order}.cpp)
endforeach()
set_source_files_properties(${PROJECT_BINARY_DIR}/unity/DESCENDING.cpp PROPERTIES COMPILE_OPTIONS
                            "-UYADE_OPENGL;-UYADE_OPENMP;-fno-openmp")

# ---------------------------------------------------------------------------------------------------------------------
# The Python package, complete in build/python, so that PYTHONPATH=build/python serves.

file(GLOB_RECURSE python_sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/scripts scripts/membrane/*.py
     scripts/membrane/Snakefile)
set(python_copies "")
foreach(file IN LISTS python_sources)
    set(source ${PROJECT_SOURCE_DIR}/scripts/${file})
    add_custom_command(OUTPUT ${python_dir}/${file} DEPENDS ${source}
                       COMMAND ${CMAKE_COMMAND} -E copy ${source} ${python_dir}/${file} VERBATIM)
    list(APPEND python_copies ${python_dir}/${file})
endforeach()
configure_file(${releases} ${python_dir}/membrane/releases.txt COPYONLY)
add_custom_target(membrane_python ALL DEPENDS ${python_copies})

# A file deleted or renamed in scripts/membrane must not live on as a copy, nor the module of another Python.
file(GLOB_RECURSE stale_copies ${python_dir}/membrane/*.py ${python_dir}/membrane/_membrane*.so)
list(REMOVE_ITEM stale_copies ${python_copies} ${python_dir}/membrane/_membrane.${Python3_SOABI}.so)
if(stale_copies)
    file(REMOVE ${stale_copies})
endif()

include(pkg/membrane/package.cmake)
