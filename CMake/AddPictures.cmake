# SPDX-License-Identifier: BSD-3-Clause
# Script: cmake -DPAGES=<folder> -DPICTURES=<folder> -P AddPictures.cmake
#
# Puts the picture of a proxy, if there is one, on top of its generated help page.
file(GLOB pages "${PAGES}/*.NURBS*.html" "${PAGES}/*.BSpline*.html")
foreach (page IN LISTS pages)
  string(REGEX REPLACE ".*\\.([A-Za-z]+)\\.html$" "\\1.png" picture "${page}")
  file(READ "${page}" text)
  if (EXISTS "${PICTURES}/${picture}" AND NOT text MATCHES "<img")
    string(REPLACE "</h2>" "</h2><p><img src=\"${picture}\"/></p>" text "${text}")
    file(WRITE "${page}" "${text}")
  endif ()
endforeach ()
