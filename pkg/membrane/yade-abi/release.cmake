# SPDX-License-Identifier: GPL-2.0-or-later
# Sets what releases.txt tells of the YADE of this machine: MEMBRANE_YADE, its version, and release_abi, release_boost,
# release_python.

set(installed_config /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/yade-double/py/yade/config.py)
set(installed_yade "")
if(EXISTS ${installed_config})
    file(STRINGS ${installed_config} version_line REGEX "^version *= *'" LIMIT_COUNT 1)
    string(REGEX REPLACE "^[^']*'([^']*)'.*" "\\1" installed_yade "${version_line}")
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${installed_config})
endif()
set(MEMBRANE_YADE "${installed_yade}" CACHE STRING "Version of the YADE to build for; default: the installed one")
if(NOT MEMBRANE_YADE)
    membrane_require(installed_yade "YADE" yade)
endif()
# Objects of another release must not stay.
if(installed_yade AND NOT MEMBRANE_YADE STREQUAL installed_yade)
    message(FATAL_ERROR "${PROJECT_BINARY_DIR} is for YADE ${MEMBRANE_YADE}, but here is YADE ${installed_yade}: "
                        "begin anew by `cmake --fresh`")
endif()

set(releases pkg/membrane/yade-abi/releases.txt)
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${releases})
file(STRINGS ${releases} rows REGEX "^[^# ]")
set(known "")
foreach(row IN LISTS rows)
    string(REGEX REPLACE " +" ";" row "${row}")
    list(GET row 0 version)
    list(APPEND known ${version})
    if(version STREQUAL MEMBRANE_YADE)
        list(GET row 1 release_abi)
        list(GET row 2 release_boost)
        list(GET row 3 release_python)
    endif()
endforeach()
if(NOT release_abi)
    list(JOIN known ", " known)
    message(FATAL_ERROR "YADE ${MEMBRANE_YADE} is none of those the plugin knows (${releases}): ${known}")
endif()
