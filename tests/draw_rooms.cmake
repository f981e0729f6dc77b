# Draws the rooms of a top folder as SVG: floors from the top down, and an arrow from each room to what
# it includes, but for what it reaches by way of another room. A room's title lists all it includes.
#
#   draw_rooms(TOP RESULT)    reads floors_TOP and, for every room, uses_ROOM
function(draw_rooms top result)
  set(box_height 30)
  set(floor_height 84)
  set(margin 20)
  set(gap 18)
  set(letter_width 8)

  # The widest floor decides the width.
  set(width 0)
  foreach(rooms ${floors_${top}})
    string(REPLACE "|" ";" rooms "${rooms}")
    set(floor_width 0)
    foreach(room ${rooms})
      string(REGEX REPLACE "^${top}/" "" name ${room})
      string(LENGTH "${name}" length)
      math(EXPR width_${room} "${length} * ${letter_width} + 24")
      math(EXPR floor_width "${floor_width} + ${width_${room}} + ${gap}")
    endforeach()
    list(APPEND floor_widths ${floor_width})
    if(floor_width GREATER width)
      set(width ${floor_width})
    endif()
  endforeach()
  math(EXPR width "${width} + 2 * ${margin}")
  list(LENGTH floor_widths num_floors)
  math(EXPR height "${num_floors} * ${floor_height} + ${margin}")

  # From the ground up, so that what a room reaches is known before it is asked for.
  set(arrows "")
  set(boxes "")
  set(floor 0)
  foreach(rooms ${floors_${top}})
    string(REPLACE "|" ";" rooms "${rooms}")
    list(GET floor_widths ${floor} floor_width)
    math(EXPR floor "${floor} + 1")
    math(EXPR y "(${num_floors} - ${floor}) * ${floor_height} + ${margin}")
    math(EXPR x "(${width} - ${floor_width} + ${gap}) / 2")
    foreach(room ${rooms})
      string(REGEX REPLACE "^${top}/" "" name ${room})
      math(EXPR middle_${room} "${x} + ${width_${room}} / 2")
      set(top_${room} ${y})
      math(EXPR text_y "${y} + 20")
      set(reached "")
      foreach(used ${uses_${room}})
        list(APPEND reached ${reaches_${used}})
      endforeach()
      math(EXPR bottom "${y} + ${box_height}")
      foreach(used ${uses_${room}})
        if(used IN_LIST reached OR NOT DEFINED top_${used})
          continue()
        endif()
        math(EXPR bend_from "${bottom} + ${floor_height} / 2")
        math(EXPR bend_to "${top_${used}} - ${floor_height} / 2")
        string(APPEND arrows "<path d=\"M${middle_${room}} ${bottom}C${middle_${room}} ${bend_from} "
               "${middle_${used}} ${bend_to} ${middle_${used}} ${top_${used}}\"/>\n")
      endforeach()
      set(reaches_${room} ${reached} ${uses_${room}})
      list(REMOVE_DUPLICATES reaches_${room})
      list(JOIN uses_${room} ", " includes)
      string(APPEND boxes "<g><title>${room} includes: ${includes}</title>"
             "<rect x=\"${x}\" y=\"${y}\" width=\"${width_${room}}\" height=\"${box_height}\" rx=\"6\"/>"
             "<text x=\"${middle_${room}}\" y=\"${text_y}\">${name}</text></g>\n")
      math(EXPR x "${x} + ${width_${room}} + ${gap}")
    endforeach()
  endforeach()

  set(${result} "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ${width} ${height}\" width=\"${width}\" height=\"${height}\">
<style>
path { fill: none; stroke: #8a94a6; stroke-width: 1.2; marker-end: url(#tip) }
rect { fill: #f3f6fb; stroke: #2f4b7c }
text { font: 13px sans-serif; text-anchor: middle; fill: #1b2a41 }
</style>
<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\"><polygon points=\"0,0 8,4 0,8\" fill=\"#8a94a6\"/></marker></defs>
<rect width=\"${width}\" height=\"${height}\" style=\"fill: white; stroke: none\"/>
${arrows}${boxes}</svg>
" PARENT_SCOPE)
endfunction()
