# cmake --install build --prefix ~/.local: Python and yade look in ~/.local/lib/python3.X/site-packages.
# cpack: the package python3-masonry, whose place is lib/python3/dist-packages (component "package").
set(MASONRY_INSTALL_DIR lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages CACHE STRING "Where the package goes, below the prefix")
set(modules masonry_core_module)
set(commands masonry) # one script under two names
if(MASONRY_YADE)
  list(APPEND modules masonry_guard_module masonry_yade_module)
  list(APPEND commands yade-masonry)
endif()

# install_masonry(<folder of Python packages> <option of install()>...)
function(install_masonry folder)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/plugin/python/masonry DESTINATION ${folder} ${ARGN} FILES_MATCHING REGEX "\\.(py|html|js|css)$" PATTERN __pycache__ EXCLUDE)
  install(FILES ${MASONRY_PACKAGE_DIR}/_build.py DESTINATION ${folder}/masonry ${ARGN})
  install(TARGETS ${modules} DESTINATION ${folder}/masonry ${ARGN})
  foreach(command ${commands})
    install(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/yade-masonry DESTINATION bin RENAME ${command} ${ARGN})
  endforeach()
endfunction()
install_masonry(${MASONRY_INSTALL_DIR})

file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
foreach(command ${commands})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/scripts/yade-masonry ${CMAKE_BINARY_DIR}/bin/${command} SYMBOLIC)
endforeach()
