# SPDX-License-Identifier: Apache-2.0
# For tests of the whole program: a folder to work in, a count of failures, and a small scene. To be sourced.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() {
  echo "$1"
  failures=$((failures + 1))
}

write_scene() { # write_scene VIEWS FROM_DEG TO_DEG HAS_ROOM: a box of cereals and one of tea on a table
  cat <<SCENE
name = "small"
[room]
enabled = $4
[camera]
width = 320
height = 240
fx = 262.5
fy = 262.5
cx = 159.5
cy = 119.5
[camera.orbit]
center_m = [0.0, 0.0, 0.80]
radius_m = 0.6
height_m = 0.35
start_deg = $2
end_deg = $3
views = $1
[[furniture]]
key = "table"
kind = "table"
size_m = [1.0, 0.7, 0.74]
[[object]]
model = "cereal_blue"
on = "table"
x_m = -0.12
[[object]]
model = "tea_box"
on = "table"
x_m = 0.15
SCENE
}
