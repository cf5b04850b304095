#!/usr/bin/env bash
# Seconds, memory and growth of portray beside POV-Ray on the same generated scenes, as a table of
# Markdown. Both trace 512 x 512 pixels on one thread, in turn; the least of RUNS runs counts.
#
#   scripts/compare-povray.sh [-p] [-r RUNS] [-n MOST] [-t SECONDS] [-k FOLDER] [CASE…]
#
#   scattered   N small solids, (sphere - cylinder) * block
#   drilled     a block minus N spheres
#   heap        a union of N spheres
#   chain       a chain of N operators, + and - in turn, from the left
#   flake       spheres on spheres, nine on each: 10, 91, 820, 7381, 66 430 for 10, 100 … 100 000
#   chess       a board with N pieces of some ten solids each, and mirrors
#   glass       the wine glass
#
# N is 10, 100 … MOST (default 10000). POV-Ray gets at most SECONDS a run (default 120); what takes
# longer is not tried with more. `-k` keeps the scenes. `-p` lets both run before all other processes, which root
# may: our seconds to trace are those of the clock, and POV-Ray's those of the processor. portray is taken from CARGO_TARGET_DIR
# (default: target) after `cargo build --release`, or from PATH. Without POV-Ray the table has our
# columns alone.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=${CARGO_TARGET_DIR:-$root/target}/release:$PATH
runs=3 most=10000 seconds=120 keep='' size=512 first=()
while getopts pr:n:t:k:s: option; do
    case $option in
    p) first=(chrt -f 40) ;;
    r) runs=$OPTARG ;;
    n) most=$OPTARG ;;
    t) seconds=$OPTARG ;;
    k) keep=$OPTARG ;;
    s) size=$OPTARG ;;
    *) exit 2 ;;
    esac
done
shift $((OPTIND - 1))
cases=("$@")
[ $# -gt 0 ] || cases=(scattered drilled heap flake chain chess glass)

if ! command -v portray >/dev/null; then
    echo "no portray; first: cargo build --release" >&2
    exit 1
fi
peer=povray
if ! command -v povray >/dev/null; then
    echo "povray is not installed: the table has the columns of portray alone" >&2
    peer=''
fi
if [ -n "$keep" ]; then
    mkdir -p "$keep"
    folder=$(cd "$keep" && pwd)
else
    folder=$(mktemp -d)
    trap 'rm -r "$folder"' EXIT
fi

# One program writes a scene in both languages, so that the numbers are the same.
generate() { # CASE N NAME
    awk -v kind="$1" -v n="$2" -v sdl="$3.sdl" -v pov="$3.pov" '
        function chance() { state = (state * 16807) % 2147483647; return state / 2147483647 }
        function both(a, b) { print a > sdl; print b > pov }
        function at(x, y, z) { return "<" x "," y "," z ">" }
        function ball(x, y, z, r) {
            s = "sphere scale " r " at (" x ", " y ", " z ")"
            p = "sphere{" at(x, y, z) "," r "}"
        }
        # Along y from the foot.
        function tube(x, y, z, h, r) {
            s = "cylinder scale (" h ", " r ", " r ") rotate (0, 0, 90) at (" x ", " y ", " z ")"
            p = "cylinder{" at(x, y, z) "," at(x, y + h, z) "," r "}"
        }
        function cone(x, y, z, h, r) {
            s = "cone scale (" h ", " r ", " r ") rotate (0, 0, -90) at (" x ", " y ", " z ")"
            p = "cone{" at(x, y, z) ",0," at(x, y - h, z) "," r "}"
        }
        function brick(x, y, z, a, b, c) {
            s = "block scale (" a ", " b ", " c ") at (" x ", " y ", " z ")"
            p = "box{" at(x - a, y - b, z - c) "," at(x + a, y + b, z + c) "}"
        }
        function view(x, y, z) {
            both("camera at (" x ", " y ", " z ") target at (0, 0, 0)",
                "#version 3.7; global_settings{assumed_gamma 1 max_trace_level 15" \
                " adc_bailout 1/256} #default{finish{ambient 0.3 diffuse 1}}" \
                " camera{perspective location " at(x, y, z) \
                " right -x*0.48 up y*0.48 direction z*1 look_at <0,0,0>}")
            both("background rgb (0.85, 0.85, 1) ambient intensity 0.3", "background{rgb <0.7,0.7,1>}")
        }
        function light(x, y, z, i) {
            both("light at (" x ", " y ", " z ") intensity " i,
                "light_source{" at(x, y, z) " rgb " i "}")
        }
        function object(look, tail, finish) {
            both("object is " look s, p_open p " " finish "}")
        }
        BEGIN {
            state = 4711
            if (kind == "scattered") {
                view(0, 12, 40); light(20, 40, 30, 0.8)
                side = exp(log(n) / 3); step = 14 / side
                for (i = 0; i < n; i++) {
                    x = 14 * (chance() - 0.5); y = 14 * (chance() - 0.5); z = 14 * (chance() - 0.5)
                    r = 0.4 * step
                    ball(x, y, z, r); a = s; pa = p
                    tube(x, y - 2 * r, z, 4 * r, 0.5 * r); b = s; pb = p
                    brick(x, y, z, r, 0.8 * r, 0.8 * r)
                    both("object is (" a " - " b ") * " s,
                        "intersection{difference{" pa pb "}" p " pigment{rgb 1}}")
                }
            } else if (kind == "drilled") {
                view(0, 12, 14); light(20, 40, 30, 0.8)
                brick(0, 0, 0, 3, 1, 3); both("object is " s, "difference{" p)
                for (i = 0; i < n; i++) {
                    r = 2.4 / sqrt(n)
                    ball(6 * (chance() - 0.5), 1 + r * (chance() - 0.5), 6 * (chance() - 0.5), r)
                    both("- " s, p)
                }
                both("", "pigment{rgb 1}}")
            } else if (kind == "heap") {
                view(0, 12, 14); light(20, 40, 30, 0.8)
                r = 2.4 / exp(log(n) / 3)
                for (i = 0; i < n; i++) {
                    ball(6 * (chance() - 0.5), 4 * (chance() - 0.5), 6 * (chance() - 0.5), r)
                    both((i ? "+ " : "object is ") s, (i ? "" : "union{") p)
                }
                both("", "pigment{rgb 1}}")
            } else if (kind == "flake") {
                view(0, 3.5, 7); light(20, 40, 30, 0.8)
                third = 2 * atan2(0, -1) / 6; levels = int(log(n) / log(10) + 0.5)
                X[0] = Y[0] = Z[0] = ux[0] = uz[0] = vy[0] = vz[0] = 0; uy[0] = vx[0] = R[0] = 1
                for (all = k = 1; k <= levels; k++) all = 9 * all + 1
                for (i = 0; i < all; i++) {
                    ball(X[i], Y[i], Z[i], R[i]); both("object is " s, "object{" p " pigment{rgb 1}}")
                    # The axes of a sphere: u away from what it sits on, v and w across.
                    wx = uy[i] * vz[i] - uz[i] * vy[i]
                    wy = uz[i] * vx[i] - ux[i] * vz[i]
                    wz = ux[i] * vy[i] - uy[i] * vx[i]
                    for (k = 1; k <= 9 && 9 * i + k < all; k++) {
                        c = 9 * i + k; turn = third * (k <= 6 ? k : 2 * k + 0.5)
                        a = k <= 6 ? 1 : 0.57735; b = k <= 6 ? 0 : 0.8165
                        d = a * cos(turn); e = a * sin(turn)
                        ux[c] = d * vx[i] + e * wx + b * ux[i]
                        uy[c] = d * vy[i] + e * wy + b * uy[i]
                        uz[c] = d * vz[i] + e * wz + b * uz[i]
                        d = b * cos(turn); e = b * sin(turn)
                        vx[c] = d * vx[i] + e * wx - a * ux[i]
                        vy[c] = d * vy[i] + e * wy - a * uy[i]
                        vz[c] = d * vz[i] + e * wz - a * uz[i]
                        R[c] = R[i] / 3; step = R[i] + R[c]
                        X[c] = X[i] + step * ux[c]; Y[c] = Y[i] + step * uy[c]
                        Z[c] = Z[i] + step * uz[c]
                    }
                }
            } else if (kind == "chain") {
                view(0, 12, 14); light(20, 40, 30, 0.8)
                for (i = n; i-- > 0;) print (i % 2 ? "difference{" : "union{") > pov
                brick(0, -0.5, 0, 3, 0.5, 3); both("object is " s, p)
                r = 2.4 / sqrt(n)
                for (i = 0; i < n; i++) {
                    ball(6 * (chance() - 0.5), 0, 6 * (chance() - 0.5), r)
                    both((i % 2 ? "- " : "+ ") s, p (i + 1 < n ? "}" : " pigment{rgb 1}}"))
                }
            } else if (kind == "chess") {
                side = int(sqrt(n) + 0.999); view(0, 0.9 * side + 2, 2.4 * side + 3)
                light(-9 * side, 20 * side, 9 * side, 0.6); light(9 * side, 9 * side, 4 * side, 0.4)
                for (i = 0; i < side * side; i++) {
                    x = i % side - side / 2; z = int(i / side) - side / 2
                    dark = (i % side + int(i / side)) % 2
                    brick(x, -0.2, z, 0.5, 0.2, 0.5)
                    both("object is smoothest shininess 0.2 " (dark ? "rgb (0.3, 0.2, 0.2) " : "") s,
                        "object{" p " pigment{rgb " (dark ? "<0.07,0.03,0.03>" : "1") \
                        "} finish{reflection 0.2}}")
                    if (i >= n) continue
                    text = ""; body = ""
                    tube(x, 0, z, 0.1, 0.4); text = s; body = p
                    tube(x, 0.1, z, 0.06, 0.34); text = text " + " s; body = body p
                    cone(x, 1.1, z, 1, 0.3); text = text " + " s; body = body p
                    tube(x, 0.7, z, 0.05, 0.24); text = text " + " s; body = body p
                    tube(x, 0.78, z, 0.04, 0.2); text = text " + " s; body = body p
                    ball(x, 1, z, 0.2); head = s; ph = p
                    brick(x, 1.1, z, 0.04, 0.3, 0.5)
                    text = text " + (" head " - " s ")"
                    body = body "difference{" ph p "}"
                    ball(x, 1.24, z, 0.06); text = text " + " s; body = body p
                    both("object is smoothest shininess 0.1 " (i % 3 ? "" : "rgb (0.4, 0.3, 0.2) ") \
                        "(" text ")", "union{" body " pigment{rgb " \
                        (i % 3 ? "1" : "<0.13,0.07,0.03>") "} finish{reflection 0.1}}")
                }
            }
        }'
}

# The least of several runs, in words of a line: CPU seconds of the whole, of tracing, and MB.
least() {
    awk '{ for (k = 1; k <= 3; k++) if (NR == 1 || $k < v[k]) v[k] = $k }
        END { if (NR) print v[1], v[2], v[3] }'
}

# What a program took besides its own words: user and system seconds, and kB at most.
measured() { # FILE COMMAND…
    local file=$1
    shift
    if [ -x /usr/bin/time ]; then
        "${first[@]}" /usr/bin/time -o "$file" -f '%U %S %M' "$@"
    else
        TIMEFORMAT='%U %S 0'
        { time "${first[@]}" "$@" 2>"$file.said"; } 2>"$file"
        cat "$file.said" >&2
    fi
}

ours() { # NAME SCENE
    measured "$1.time" portray "$2" -q --samples 1 --max-primitives 100000000 --size "${size}x$size" --threads 1 \
        -o "$1.ours.png" --stats "$1.json" || return 1
    sed -n 's/.*"trace_seconds": \([0-9.]*\).*/\1/p' "$1.json" >"$1.trace"
    awk 'NR == FNR { trace = $1; next } { print $1 + $2, trace, $3 / 1024 }' "$1.trace" "$1.time"
}

theirs() { # NAME SCENE
    measured "$1.time" timeout "$seconds" povray "+I$2" "+O$1.peer.png" "+W$size" "+H$size" \
        -A -D +WT1 >"$1.said" 2>&1 || return 1
    sed -n 's/.*using 1 thread(s) with \([0-9.]*\) CPU-seconds.*/\1/p' "$1.said" |
        tail -n 1 >"$1.trace"
    awk 'NR == FNR { trace = $1; next } { print $1 + $2, trace, $3 / 1024 }' "$1.trace" "$1.time"
}

if [ -n "$peer" ]; then
    echo '| scene | N | portray: CPU s | trace | MB | POV-Ray: CPU s | trace | MB | trace, ratio |'
    echo '|---|--:|--:|--:|--:|--:|--:|--:|--:|'
else
    echo '| scene | N | portray: CPU s | trace | MB |'
    echo '|---|--:|--:|--:|--:|'
fi
for kind in "${cases[@]}"; do
    : >"$folder/growth"
    slow=''
    for ((n = 10; n <= most; n *= 10)); do
        name=$folder/$kind-$n
        scene=$name.sdl model=$name.pov
        if [ "$kind" = glass ]; then
            [ "$n" -eq 10 ] || break
            scene=$root/scenes/wine-glass/wine-glass.sdl
            model=$root/crates/render/benches/peers/wine-glass.pov
        else
            generate "$kind" "$n" "$name"
            if [ ! -s "$scene" ]; then
                echo "no case $kind; expected some of scattered drilled heap flake chain chess glass" >&2
                exit 2
            fi
        fi
        : >"$name.a"
        : >"$name.b"
        for ((run = 0; run < runs; run++)); do
            ours "$name" "$scene" >>"$name.a" || { echo "$kind $n: portray failed" >&2; exit 1; }
            if [ -n "$peer" ] && [ -z "$slow" ]; then
                theirs "$name" "$model" >>"$name.b" || slow=yes
            fi
        done
        [ -z "$slow" ] || : >"$name.b"
        a=$(least <"$name.a") b=$(least <"$name.b")
        [ "$kind" = glass ] && shown='' || shown=$n
        echo "$n $a" >>"$folder/growth"
        echo "$kind|$shown|$a|$b|$peer" | awk -F'|' '{
            split($3, a, " "); split($4, b, " ")
            printf "| %s | %s | %.3f | %.3f | %.0f |", $1, $2, a[1], a[2], a[3]
            if ($5 == "") { print ""; next }
            if ($4 == "") { print " too slow | | | |"; next }
            printf " %.3f | %.3f | %.0f | %.3f |\n", b[1], b[2], b[3], a[2] / (b[2] > 0 ? b[2] : 0.001)
        }'
    done
    # Least squares of the logarithms, from N = 1000 on if there are two.
    awk -v kind="$kind" '{ n[NR] = $1; t[NR] = $3 }
        END {
            from = 1
            while (n[from] < 1000 && NR - from >= 2 && n[NR] > 1000) from++
            for (k = from; k <= NR; k++) {
                x = log(n[k]); y = log(t[k] + 1e-4); c++; sx += x; sy += y; sxx += x * x; sxy += x * y
            }
            if (c > 1)
                printf "\n%s: portray traces in N^%.2f from %d to %d\n\n", kind,
                    (c * sxy - sx * sy) / (c * sxx - sx * sx), n[from], n[NR]
        }' "$folder/growth" >>"$folder/slopes"
done
cat "$folder/slopes"
[ -z "$keep" ] || rm -f "$folder"/{growth,slopes} "$folder"/*.{time,trace,said,json,a,b}
