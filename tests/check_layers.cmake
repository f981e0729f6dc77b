# Fails when a file includes something its folder may not know about.
# Debian installs third-party headers in /usr/include, so PRIVATE linking alone cannot hide them.

# Own headers: which folders each folder may include.
set(own_renderer/core "renderer/core/")
set(own_renderer      "renderer/")
set(own_nlos          "renderer/core/|nlos/")
set(own_calib         "renderer/|calib/")
set(own_apps          "renderer/|nlos/|calib/|apps/")

# Third-party headers: which may appear in the .cpp files of each folder. Headers get only "anywhere".
set(anywhere
    "Eigen/|tbb/|nlohmann/|fmt/|sys/|unistd\\.h|fcntl\\.h|immintrin\\.h|experimental/simd")
set(third_renderer/core "${anywhere}|flann/|malloc\\.h")
set(third_renderer      "${anywhere}|embree3/|tiny_gltf")
set(third_nlos          "${anywhere}|fftw3\\.h|hdf5\\.h|matio\\.h|Imf|OpenEXR/|opencv2/")
set(third_calib         "${anywhere}|ceres/|opencv2/")
set(third_apps          "${anywhere}|CLI/|opencv2/")

set(errors "")
foreach(folder renderer/core renderer nlos calib apps)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cpp)
  if(folder STREQUAL "renderer")
    list(FILTER files EXCLUDE REGEX "^renderer/core/")
  endif()
  foreach(file ${files})
    file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[\"<]")
    foreach(line ${lines})
      if(line MATCHES "include[ \t]*\"([^\"]+)\"")
        set(included ${CMAKE_MATCH_1})
        set(allowed "${own_${folder}}")
      elseif(line MATCHES "include[ \t]*<([^>]*[/.][^>]*)>")  # <vector> and other bare names are standard
        set(included ${CMAKE_MATCH_1})
        set(allowed "${third_${folder}}")
        if(file MATCHES "\\.h$" AND NOT folder STREQUAL "apps")  # apps is nobody's library
          set(allowed "${anywhere}")
        endif()
      else()
        continue()
      endif()
      if(NOT included MATCHES "^(${allowed})")
        string(APPEND errors "\n  ${file} includes ${included}")
      endif()
    endforeach()
  endforeach()
endforeach()
if(errors)
  message(FATAL_ERROR "Forbidden includes (see CONTRIBUTING.md, layers):${errors}")
endif()
