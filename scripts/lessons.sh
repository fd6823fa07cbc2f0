#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders the images of the lesson pages: scripts/lessons.sh QUINTET [OUTPUT_FOLDER] [NAME…]
# Renders all lessons if no name is given. The frame counts, parameters and size are those of docs/images/lessons. The pairs
# of images in the pages are results of the commands on the page, at 192x128.
set -euo pipefail

quintet=${1:?usage: lessons.sh QUINTET [OUTPUT_FOLDER] [NAME…]}
folder=${2:-docs/images/lessons}
shift $(($# < 2 ? $# : 2))
mkdir -p "$folder"

lesson() {  # NAME OPTIONS…
    local name=$1
    shift
    if ((${#wanted[@]} > 0)) && [[ " ${wanted[*]} " != *" $name "* ]]; then return; fi
    echo "lessons/$name"
    "$quintet" run "lessons/$name" -o "$folder/$name.png" --size 480x320 --quiet "$@"
}
wanted=("$@")

lesson 01_first_ray
lesson 02_cameras
lesson 03_mesh_data --set show=1
lesson 04_diffuse
lesson 05_shadow --frames 8
lesson 06_mirror_loop
lesson 07_mirror_recursion
lesson 08_refraction
lesson 09_progressive --frames 64
lesson 10_sphere
lesson 11_many_spheres
lesson 12_box
lesson 13_triangle
lesson 14_csg
lesson 14_csg_tree --spp 1
lesson 15_any_hit
lesson 16_callable
lesson 17_records --spp 1
lesson 18_instances
lesson 19_dynamic --frames 14
lesson 20_lambert --spp 1
lesson 21_one_weekend --frames 16
lesson 22_path_tracer --frames 32
lesson 23_monte_carlo --frames 64
lesson 24_cosine_sampling --frames 16
lesson 25_next_event --frames 16
lesson 26_mis --frames 16
lesson 27_roulette --frames 16

# page NAME FILE=IMAGE…: runs the commands of a page and keeps images that they write, for comparisons on the page.
page() {
    local name=$1 kept pair
    shift
    if ((${#wanted[@]} > 0)) && [[ " ${wanted[*]} " != *" $name "* ]]; then return; fi
    echo "docs/lessons/$name.md"
    kept=$(mktemp -d)
    PAGES_SIZE=192x128 PAGES_KEEP=$kept bash tests/lessons/pages "$quintet" "docs/lessons/$name.md" > "$kept/log"
    for pair in "$@"; do cp "$kept/${pair%=*}" "$folder/${name%%_*}_${pair#*=}.png"; done
    rm -r "$kept"
}
page 03_mesh_data wrong.png=wrong right.png=right
page 05_shadow acne.png=acne first.png=clean
page 06_mirror_loop level1.png=level1 level2.png=level2 mirror_loop.png=level5
page 08_refraction refraction.png=plain fresnel.png=fresnel
page 09_progressive one.png=frames1 halton.png=frames16 progressive.png=frames64
page 22_path_tracer noisy.png=without path_tracer.png=with
page 23_monte_carlo frame.png=frames1 frames16.png=frames16 monte_carlo.png=frames64
page 24_cosine_sampling uniform.png=uniform cosine4.png=cosine
page 25_next_event directions.png=directions next_event.png=points
page 26_mis reflection.png=reflection lamps.png=lamps mis.png=both
page 27_roulette direct.png=bounces1 two.png=bounces2 roulette.png=bounces64
