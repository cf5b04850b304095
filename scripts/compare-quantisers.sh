#!/usr/bin/env bash
# Compares the quantisers of the suite with those of others: 256 colours, at several sizes, on one
# thread and on two. Prints a table for each size.
#
#   compare-quantisers.sh [-s "MEGAPIXELS…"] [-r RUNS] [-c FILE.csv] [-x] [PICTURE…]
#
#   -s SIZES   sizes that the pictures are brought to (default: "0.26 0.8 1.8 12")
#   -r RUNS    times are the least of so many runs (default: 3)
#   -c FILE    also write the figures of each picture, with commas
#   -x         without the program built of other people's libraries: libimagequant, quantette,
#              SSIMULACRA2 and DSSIM are left out
#   -h         this text
#
# Without pictures, some of the repository and a gradient are taken. Quality is PSNR in decibels
# (more is better), SSIMULACRA2 (more is better, 100 at most) and DSSIM in millionths (less is
# better), the mean over all pictures. `memory` is milliseconds from pixels to indices, `files` from
# file to file, on one thread and on two. What is not installed is said, and left out.
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH, then from a release build here.

set -euo pipefail
export LC_ALL=C

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

sizes="0.26 0.8 1.8 12" runs=3 csv='' libraries=1
while getopts s:r:c:xh option; do
    case $option in
        s) sizes=$OPTARG ;;
        r) runs=$OPTARG ;;
        c) csv=$OPTARG ;;
        x) libraries=0 ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[[ $runs =~ ^[1-9][0-9]{0,3}$ ]] || fail "expected a number of runs as 3, found $runs; see -h"
for size in $sizes; do
    [[ $size =~ ^[0-9]{1,2}(\.[0-9]{1,6})?$ && ! $size =~ ^[0.]*$ ]] ||
        fail "expected sizes in megapixels as \"0.26 12\", found $size; see -h"
done

root=$(cd -P "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
PATH=$PATH:$target/release
for program in icopy iencode ierr; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

missing=()
needs() { # PROGRAM WHAT
    command -v "$1" >/dev/null && return
    missing+=("$2")
    return 1
}
peers=''
if ((libraries)); then
    manifest=$root/tools/ilut/benches/peers/Cargo.toml
    if (cd "$root" && cargo build --release --quiet --manifest-path "$manifest" \
        --target-dir "$target") 2>"$folder/build"; then
        peers=$target/release/quantiser-peers
    else
        tail -n 3 "$folder/build" >&2
        missing+=("libimagequant, quantette, SSIMULACRA2 and DSSIM (their build failed)")
    fi
else
    missing+=("libimagequant, quantette, SSIMULACRA2 and DSSIM (-x)")
fi

# Each is called with the number of threads, the picture, the result, and words of its own.
ours() {
    local threads=$1 in=$2 out=$3
    shift 3
    iencode -q --threads "$threads" "$in" -o "$out" "$@"
}
with_pngquant() {
    local threads=$1 in=$2 out=$3
    shift 3
    OMP_NUM_THREADS=$threads RAYON_NUM_THREADS=$threads pngquant --force --output "$out" "$@" 256 "$in"
}
with_imagemagick() {
    local threads=$1 in=$2 out=$3
    shift 3
    MAGICK_THREAD_LIMIT=$threads convert "$in" "$@" -colors 256 "PNG8:$out"
}
with_netpbm() {
    local in=$2 out=$3
    shift 3
    pngtopnm "$in" | pnmquant "$@" 256 2>/dev/null | pnmtopng 2>/dev/null >"$out"
}

# Name, word of the library program, command.
rows=(
    "ilut heckbert|heckbert|ours --method heckbert"
    "ilut fast|fast|ours --method fast"
    "ilut best rgb|best|ours"
    "ilut best oklab|oklab|ours --metric oklab"
    "… Floyd-Steinberg|oklab-fs|ours --metric oklab --dither floyd-steinberg"
    "… blue noise|oklab-noise|ours --metric oklab --dither blue-noise"
)
if needs pngquant pngquant; then
    for speed in 1 4 10; do
        rows+=("pngquant speed $speed||with_pngquant --speed $speed --nofs")
        rows+=("… dithered||with_pngquant --speed $speed")
    done
fi
if [ -n "$peers" ]; then
    for speed in 1 4 10; do
        rows+=("libimagequant speed $speed|imagequant-$speed|")
        rows+=("… dithered|imagequant-$speed-fs|")
    done
    rows+=("quantette Wu|quantette-wu|" "… dithered|quantette-wu-fs|")
    rows+=("quantette k-means|quantette-kmeans|" "… dithered|quantette-kmeans-fs|")
fi
if needs convert ImageMagick; then
    rows+=("ImageMagick||with_imagemagick +dither")
    rows+=("… dithered||with_imagemagick -dither FloydSteinberg")
fi
if needs pnmquant netpbm && needs pngtopnm netpbm; then
    rows+=("netpbm||with_netpbm -nofloyd" "… dithered||with_netpbm -floyd")
fi

pictures=("$@")
if [ $# -eq 0 ]; then
    awk 'BEGIN {
        print "P3 256 192 255"
        for (y = 0; y < 192; y++) for (x = 0; x < 256; x++)
            printf "%d %d %d\n", 40 + x * 0.8, 60 + y, 220 - (x + y) * 0.4
    }' >"$folder/gradient.ppm"
    pictures=("$root"/scenes/gallery/{aquarium,gears,planet}.png
        "$root"/scenes/{spindles/spindles,wine-glass/wine-glass}.png
        "$root"/docs/textures/{marble,pictures/map}.png "$folder/gradient.ppm")
fi

# Least milliseconds of a command on one thread and on two, in turn.
in_files() { # COMMAND… with IN and OUT in $in and $out
    local start end threads took least=('' '') work=$1
    shift
    for ((run = 0; run < runs; run++)); do
        for threads in 1 2; do
            # netpbm has one thread.
            if [ "$work $threads" = "with_netpbm 2" ]; then continue; fi
            start=${EPOCHREALTIME/./}
            "$work" "$threads" "$in" "$out" "$@" >"$folder/said" 2>&1 || {
                cat "$folder/said" >&2
                exit 1
            }
            end=${EPOCHREALTIME/./}
            took=$((end - start))
            if [ -z "${least[threads - 1]}" ] || ((took < least[threads - 1])); then
                least[threads - 1]=$took
            fi
        done
    done
    for took in "${least[@]}"; do
        [ -z "$took" ] || took=$((took / 1000)).$(printf %03d $((took % 1000)))
        printf '%s,' "$took"
    done
}

header=megapixels,picture,method,psnr,ssimulacra2,dssim,memory1,memory2,files1,files2,bytes
echo "$header" >"$folder/figures"
in=$folder/in.png out=$folder/out.png
for size in $sizes; do
    for picture in "${pictures[@]}"; do
        icopy -q "$picture" "$folder/whole" --flatten '#ffffff' --depth 8 --channels rgb
        read -r _ columns rows_of _ < <(grep '^size ' "$folder/whole.idf")
        to=$(awk -v m="$size" -v c="$columns" -v r="$rows_of" 'BEGIN {
            w = int(sqrt(m * 1e6 * c / r) + 0.5); w = w < 1 ? 1 : w
            h = int(m * 1e6 / w + 0.5); print w "x" (h < 1 ? 1 : h)
        }')
        icopy -q "$folder/whole" "$in" --resize "$to"
        for row in "${rows[@]}"; do
            IFS='|' read -r name word work <<<"$row"
            case $name in "… "*) name="$whole, ${name#… }" ;; *) whole=$name ;; esac
            memory=, files=,
            if [ -n "$peers" ] && [ -n "$word" ]; then
                memory=$("$peers" quantise "$word" "$runs" "$in" "$out" | tr ' ' ',')
            fi
            if [ -n "$work" ]; then
                # shellcheck disable=SC2086 # words of a command
                files=$(in_files $work)
                files=${files%,}
            fi
            psnr=$(ierr -q --metrics psnr "$in" "$out" | awk '$1 == "psnr" { print $2 }')
            seen=,
            # Beyond 4 megapixels these two measures want gigabytes.
            if [ -n "$peers" ] && awk -v m="$size" 'BEGIN { exit m > 4 }'; then
                seen=$("$peers" compare "$in" "$out" | tr ' ' ',')
            fi
            bytes=$(wc -c <"$out" | tr -d ' ')
            name=${name//, /: }
            echo "$size,$(basename "${picture%.*}"),$name,$psnr,$seen,$memory,$files,$bytes" \
                >>"$folder/figures"
        done
    done
done
[ -z "$csv" ] || cp "$folder/figures" "$csv"

awk -F, '
    function mean(sum, count, form) { return count > 0 ? sprintf(form, sum / count) : "–" }
    NR == 1 { next }
    !($1 in known) { known[$1]; sizes[++count] = $1 }
    !($3 in named) { named[$3]; names[++methods] = $3 }
    {
        key = $1 SUBSEP $3
        if ($4 ~ /^-?[0-9]/) { sum[key, 4] += $4; many[key, 4]++ } else exact[key]++
        for (at = 5; at <= 11; at++) if ($at != "") { sum[key, at] += $at; many[key, at]++ }
        if (!(($1, $2) in seen)) { seen[$1, $2]; pictures[$1]++ }
    }
    END {
        for (s = 1; s <= count; s++) {
            printf "%s%s megapixels, %d pictures\n\n", (s > 1 ? "\n" : ""), sizes[s], pictures[sizes[s]]
            print "| method | dB | SSIMULACRA2 | DSSIM | memory 1 | 2 | files 1 | 2 | KB |"
            print "|---|--:|--:|--:|--:|--:|--:|--:|--:|"
            for (m = 1; m <= methods; m++) {
                key = sizes[s] SUBSEP names[m]
                printf "| %s | %s", names[m], mean(sum[key, 4], many[key, 4], "%.2f")
                if (exact[key]) printf " (%d exact)", exact[key]
                printf " | %s", mean(sum[key, 5], many[key, 5], "%.2f")
                printf " | %s", mean(sum[key, 6], many[key, 6], "%.0f")
                for (at = 7; at <= 10; at++) printf " | %s", mean(sum[key, at], many[key, at], "%.1f")
                printf " | %s |\n", mean(sum[key, 11] / 1000, many[key, 11], "%.1f")
            }
        }
        print "\nPictures that come back exactly are left out of the mean of dB; their number is told."
    }' "$folder/figures"
((${#missing[@]} == 0)) || printf 'Left out, not installed: %s\n' "${missing[@]}"
