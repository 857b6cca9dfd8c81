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

move_cereals() { # move_cereals VIEW: before this view
  printf '[[change]]\nview = %d\nkind = "move"\nobject = "cereal_blue"\non = "table"\n' "$1"
  printf 'x_m = -0.05\ny_m = 0.12\nyaw_deg = 10\n'
}

remove_tea() { # remove_tea VIEW
  printf '[[change]]\nview = %d\nkind = "remove"\nobject = "tea_box"\n' "$1"
}

write_changing_scene() { # five views: the cereals move in the third, the tea is gone in the fourth
  write_scene 5 -110 -70 true
  move_cereals 2
  remove_tea 3
}

run() { # run COMMAND ARGUMENTS...: ends the test if the command of $resight fails
  "$resight" "$@" >log 2>&1 || { fail "$1 failed: $(tail -1 log)"; exit 1; }
}
