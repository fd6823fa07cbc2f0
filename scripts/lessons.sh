#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders the images of the lesson pages: scripts/lessons.sh QUINTET [OUTPUT_FOLDER] [NAME…]
# Renders all lessons if no name is given. The frame counts, parameters and size are those of docs/images/lessons.
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
lesson 14_csg_tree
lesson 15_any_hit
lesson 16_callable
lesson 17_records --spp 1
lesson 18_instances
lesson 19_dynamic --frames 14
lesson 20_lambert --spp 1
lesson 21_one_weekend --frames 16
lesson 22_path_tracer --frames 32
