# The order of the rooms, a test that no include goes against it, and one that no kind is named outside
# its own file and list.
#
#   cmake -DROOT=. -P tests/check_layers.cmake             fails with the offending include or line
#   cmake -DROOT=. -DWRITE=ON -P tests/check_layers.cmake  draws the rooms of every top folder anew, rooms.svg
#
# A room is one folder of sources. It may include itself and rooms on lower floors of its own top
# folder, and the top folders that `below_` lists; so no two rooms include each other.
cmake_minimum_required(VERSION 3.25)

set(floors_renderer
    "renderer/core"
    "renderer/core/settings"
    "renderer/core/system"
    "renderer/core/capture|renderer/core/mesh_formats"
    "renderer/settings|renderer/material|renderer/triangle"
    "renderer/gltf|renderer/mesh_file|renderer/film"
    "renderer/scene"
    "renderer/geometry|renderer/path|renderer/scene_import"
    "renderer/third_bounce|renderer/ellipsoidal|renderer/shift"
    "renderer/restir"
    "renderer")
set(floors_nlos
    "nlos/containers|nlos/fourier|nlos/detector|nlos/reconstruction|nlos/canvas"
    "nlos/layouts|nlos/containers/writers|nlos/plots"
    "nlos/formats|nlos/compare|nlos/preparation"
    "nlos/preparation/checks"
    "nlos/methods|nlos/pictures"
    "nlos/solver"
    "nlos")
set(floors_calib
    "calib/statistics|calib/model"
    "calib/model/parameters"
    "calib/forward|calib/setup|calib/track"
    "calib/fit|calib/adjoint"
    "calib")
set(floors_apps
    "apps"
    "apps/batch|apps/manual|apps/shapes|apps/tables"
    "apps/dataset"
    "apps/page"
    "apps/report"
    "apps/commands"
    "apps/python|apps/sweep|apps/bench"
    "apps/bench/render|apps/bench/reconstruct|apps/bench/fit|apps/bench/field"
    "apps/bench/program")

# What lies below a whole top folder.
set(below_renderer "")
set(below_nlos "renderer/core/")
set(below_calib "renderer/")
set(below_apps "renderer/|nlos/|calib/")

# Third-party headers. Debian installs them in /usr/include, so PRIVATE linking alone cannot hide
# them. "anywhere" may stand in every file, the others only in .cpp files of the rooms named (in
# apps, which is nobody's library, also in headers), and in the headers of our own that only such
# files include and that are not installed.
set(private_headers renderer/scene/embree.h)
set(anywhere
    "Eigen/|tbb/|nlohmann/|fmt/|sys/|unistd\\.h|spawn\\.h|fcntl\\.h|poll\\.h|dlfcn\\.h|link\\.h|immintrin\\.h|experimental/simd")
set(third_renderer/core "flann/")
set(third_renderer/core/system "malloc\\.h")
set(third_renderer/gltf "tiny_gltf")
set(third_renderer/scene "embree[34]/")
set(third_renderer/scene_import "pugixml\\.hpp|yaml-cpp/")
set(third_nlos/containers "hdf5\\.h|matio\\.h|zip\\.h|OpenEXR/|zlib\\.h|isa-l/")
set(third_nlos/containers/writers "zlib\\.h|hdf5\\.h|matio\\.h|zip\\.h")
set(third_nlos/fourier "fftw3\\.h")
set(third_nlos/canvas "cairo[-.]|opencv2/imgproc|isa-l/|turbojpeg\\.h")
set(third_calib/statistics "glog/")
set(third_calib/setup "ceres/|opencv2/|png\\.h|turbojpeg\\.h")
set(third_calib/fit "ceres/")
set(third_apps "CLI/")
set(third_apps/batch "xxhash\\.h")
set(third_apps/dataset "meshoptimizer\\.h")
set(third_apps/page "zlib\\.h")
set(third_apps/bench "CLI/")
set(third_apps/python "nanobind/|pthread\\.h")

# A kind is named in its own file and its list alone; elsewhere its row is asked. The benchmarks compare
# kinds by name, and `Auto` is what settings hold before a kind is chosen.
set(kinds surface estimator method)
set(named_surface "SurfaceModel::[A-Z]|[^A-Za-z_\"](Lambertian|GgxConductor|GgxDielectric|Retroreflective)[^A-Za-z_ ]")
set(home_surface "^renderer/material/|^calib/track/track_settings\\.h$")  # a target may be one, too
set(named_estimator "[^A-Za-z_]Estimator::([B-Z]|A[^u])")
set(home_estimator "^renderer/[a-z_]+_render\\.(cpp|h)$|^renderer/render_result\\.h$|^renderer/restir/|^renderer/settings/|^apps/bench/")
set(named_method "[^A-Za-z_]Method::([B-Z]|A[^u])")
set(home_method "^nlos/methods/|^nlos/solver/solver\\.cpp$")

get_filename_component(ROOT ${ROOT} ABSOLUTE)
set(errors "")
set(misnamed "")
include(${CMAKE_CURRENT_LIST_DIR}/draw_rooms.cmake)
foreach(top renderer nlos calib apps)
  set(lower "")  # rooms on the floors below
  set(floor 0)
  foreach(rooms ${floors_${top}})
    math(EXPR floor "${floor} + 1")
    string(REPLACE "|" ";" rooms "${rooms}")
    foreach(room ${rooms})
      list(APPEND known ${room})
      file(GLOB files RELATIVE ${ROOT} ${ROOT}/${room}/*.h ${ROOT}/${room}/*.cpp)
      set(uses "")
      set(num_lines 0)
      foreach(file ${files})
        file(STRINGS ${ROOT}/${file} text)
        list(LENGTH text length)
        math(EXPR num_lines "${num_lines} + ${length}")
        foreach(kind ${kinds})
          if(file MATCHES "${home_${kind}}")
            continue()
          endif()
          file(STRINGS ${ROOT}/${file} lines REGEX "${named_${kind}}")
          list(FILTER lines EXCLUDE REGEX "^ *//")
          foreach(line ${lines})
            string(STRIP "${line}" line)
            string(APPEND misnamed "\n  ${file}: ${kind}: ${line}")
          endforeach()
        endforeach()
        file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[\"<]")
        foreach(line ${lines})
          if(line MATCHES "include[ \t]*\"([^\"]+)\"")
            set(included ${CMAKE_MATCH_1})
            get_filename_component(used ${included} DIRECTORY)
            set(below "${below_${top}}")
            if(NOT used IN_LIST lower AND NOT used STREQUAL room
               AND (below STREQUAL "" OR NOT included MATCHES "^(${below})"))
              string(APPEND errors "\n  ${file} includes ${included}")
            elseif(NOT used STREQUAL room)
              list(APPEND uses ${used})
            endif()
          elseif(line MATCHES "include[ \t]*<([^>]*[/.][^>]*)>")  # <vector> and other bare names are standard
            set(included ${CMAKE_MATCH_1})
            set(allowed "${anywhere}")
            if(DEFINED third_${room}
               AND (file MATCHES "\\.cpp$" OR top STREQUAL "apps" OR file IN_LIST private_headers))
              string(APPEND allowed "|${third_${room}}")
            endif()
            if(NOT included MATCHES "^(${allowed})")
              string(APPEND errors "\n  ${file} includes ${included}")
            endif()
          endif()
        endforeach()
      endforeach()
      list(REMOVE_DUPLICATES uses)
      list(SORT uses)
      set(uses_${room} ${uses})
      list(LENGTH files num_files)
      message(STATUS "${room}: ${num_files} files, ${num_lines} lines that are not blank")
    endforeach()
    list(APPEND lower ${rooms})
  endforeach()
endforeach()

# A folder of sources that no floor names would go unchecked.
foreach(top renderer nlos calib apps)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${top}/*.h ${ROOT}/${top}/*.cpp)
  foreach(file ${files})
    get_filename_component(room ${file} DIRECTORY)
    if(NOT room IN_LIST known)
      string(APPEND errors "\n  ${file} stands in no room known to tests/check_layers.cmake")
    endif()
  endforeach()
endforeach()

if(errors)
  message(FATAL_ERROR "Forbidden includes (see CONTRIBUTING.md, rooms):${errors}")
endif()

if(misnamed)
  message(FATAL_ERROR "Kinds are named outside their own file and list (see CONTRIBUTING.md, adding things):${misnamed}")
endif()

foreach(top renderer nlos calib apps)
  draw_rooms(${top} picture)
  set(path ${ROOT}/${top}/rooms.svg)
  set(drawn "")
  if(EXISTS ${path})
    file(READ ${path} drawn)
  endif()
  if(WRITE)
    file(WRITE ${path} "${picture}")
  elseif(NOT drawn STREQUAL picture)
    message(FATAL_ERROR "${top}/rooms.svg is not what the includes say; draw it anew: "
                        "cmake -DROOT=. -DWRITE=ON -P tests/check_layers.cmake")
  endif()
endforeach()
