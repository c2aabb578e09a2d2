# What a run of the two flaps gave: each is the mirror image of the other. summary.txt, then history.csv. Exits 1 where they are not,
# to what the tolerance of the loads leaves.
BEGIN { FS = "," }
FNR == NR { next }
FNR == 1 { next }
function size(x) { return x < 0 ? -x : x }
{
    lines++
    off = size($2 - $14) + size($3 + $15); if (off > worst) worst = off
    if ($2 > most) most = $2
    if (size($16) + size($4) > out) out = size($16) + size($4)
}
END {
    bound = 100 * rtol
    printf "  %-42s %.1e of the largest %.4g m (at most %.0e)\n", "off the other's mirror image", worst / most, most, bound
    exit !(lines > 0 && most > 1e-3 && worst < bound * most && out < 1e-6 * most)
}
