# Fails when a README names a file or folder of ours that does not exist.
#
#   cmake -DROOT=. -P tests/check_texts.cmake
#
# What counts: links, and names in backticks that end in .h, .cpp, .cmake or .md, or in a slash.
# They are looked up from the text's folder, from the rooms in it, and from the root.
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT ${ROOT} ABSOLUTE)

set(errors "")
file(GLOB texts RELATIVE ${ROOT} ${ROOT}/*.md ${ROOT}/*/README.md ${ROOT}/*/*/README.md ${ROOT}/apps/guide/*.md)
foreach(text ${texts})
  get_filename_component(folder ${ROOT}/${text} DIRECTORY)
  file(READ ${ROOT}/${text} content)
  string(REGEX REPLACE "[][;]" "|" content "${content}")  # CMake's lists would stumble over these
  string(REGEX MATCHALL "\\|\\([^)]*\\)|`[A-Za-z0-9_./-]+(\\.h|\\.cpp|\\.cmake|\\.md|/)`" names "${content}")
  foreach(name ${names})
    string(REGEX REPLACE "^(\\|\\(|`)" "" name "${name}")
    string(REGEX REPLACE "/?[)`]$" "" name "${name}")
    string(REGEX REPLACE "#.*$" "" name "${name}")
    if(name STREQUAL "" OR name MATCHES "^(https?:|/)|^build/")
      continue()
    endif()
    file(GLOB found ${folder}/${name} ${folder}/*/${name} ${ROOT}/${name} ${ROOT}/*/${name})
    if(NOT found)
      string(APPEND errors "\n  ${text} names ${name}")
    endif()
  endforeach()
endforeach()
if(errors)
  message(FATAL_ERROR "Texts name what does not exist:${errors}")
endif()
