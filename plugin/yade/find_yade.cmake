# The packaged YADE in double precision: its version, its features, and the headers that fit it.
#   YADE_VERSION, YADE_FEATURES (list), YADE_BUILD_ID (of libyade.so)
#   YADE_HEADERS      folder of its own headers; empty: plugin/abi fits
#   YADE_DEFINITIONS  what its headers must be compiled with
set(MASONRY_YADE_LIBRARY_DIR /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/yade-double CACHE PATH "Where libyade.so is")
set(YADE_SOURCE_DIR "" CACHE PATH "YADE's own sources of the same version; default: <build folder>/yade-source, where plugin/abi does not fit")
if(NOT EXISTS ${MASONRY_YADE_LIBRARY_DIR}/libyade.so)
  message(FATAL_ERROR "There is no YADE in ${MASONRY_YADE_LIBRARY_DIR}: install it with `apt install yade`, or build the theory "
    "alone with -DMASONRY_YADE=OFF.")
endif()

# Its configuration is a Python file, which may look for settings in the home folder.
execute_process(COMMAND ${CMAKE_COMMAND} -E env HOME=${CMAKE_BINARY_DIR} ${Python3_EXECUTABLE} -c "
import runpy, sys
config = runpy.run_path(sys.argv[1])
print(config['version'], config['highPrecisionBits'], config['highPrecisionDecimalPlaces'], *sorted(set(config['features'])), sep=';')"
  ${MASONRY_YADE_LIBRARY_DIR}/py/yade/config.py OUTPUT_VARIABLE YADE_FEATURES OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
list(POP_FRONT YADE_FEATURES YADE_VERSION bits decimals)
execute_process(COMMAND readelf -n ${MASONRY_YADE_LIBRARY_DIR}/libyade.so OUTPUT_VARIABLE notes ERROR_QUIET)
string(REGEX MATCH "Build ID: ([0-9a-f]+)" notes "${notes}")
set(YADE_BUILD_ID "${CMAKE_MATCH_1}")

set(YADE_HEADERS "" CACHE INTERNAL "") # the tests see it too
if(YADE_SOURCE_DIR)
  set(source ${YADE_SOURCE_DIR})
elseif(YADE_VERSION STREQUAL "2023.02a" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  return()
else()
  set(source ${CMAKE_BINARY_DIR}/yade-source/yade-${YADE_VERSION})
  if(NOT EXISTS ${source}/core/Scene.hpp)
    message(FATAL_ERROR "The headers of YADE ${YADE_VERSION} are not here: run `scripts/yade-source ${CMAKE_BINARY_DIR}/yade-source`, which "
      "fetches them with apt, or unpack the source of exactly YADE ${YADE_VERSION} and give its folder as -DYADE_SOURCE_DIR=<folder>.")
  endif()
endif()
set(YADE_HEADERS ${source} CACHE INTERNAL "")
if(NOT EXISTS ${source}/core/Scene.hpp)
  message(FATAL_ERROR "YADE_SOURCE_DIR=${source} holds no sources of YADE (core/Scene.hpp): give the folder of YADE ${YADE_VERSION}'s sources.")
endif()

# Features of YADE that change what its headers declare. A wrong or missing one is found by the guard when the plugin is loaded.
set(YADE_DEFINITIONS YADE_REAL_BIT=${bits} YADE_REAL_DEC=${decimals} MAX_LOG_LEVEL=3) # of the log: up to warnings
foreach(pair OPENMP=YADE_OPENMP MPI=YADE_MPI FEMLIKE=YADE_FEM LS_DEM=YADE_LS_DEM QT5=YADE_QT5 QT6=YADE_QT6 DEFORM=YADE_DEFORM SPH=YADE_SPH
    LIQMIGRATION=YADE_LIQMIGRATION MASK_ARBITRARY=YADE_MASK_ARBITRARY PROFILING=USE_TIMING_DELTAS)
  string(REPLACE "=" ";" pair ${pair})
  list(GET pair 0 feature)
  list(GET pair 1 definition)
  if(feature IN_LIST YADE_FEATURES)
    list(APPEND YADE_DEFINITIONS ${definition})
  endif()
endforeach()
if(EXISTS ${MASONRY_YADE_LIBRARY_DIR}/py/yade/qt/_GLViewer.so) # no feature says whether it was built with OpenGL
  list(APPEND YADE_DEFINITIONS YADE_OPENGL)
endif()
