# What a run of the hub with its blades gave. The flow's force on all their faces (history.csv) is the sum of the members' loads
# (hub.txt, from the session), and the blades' roots are where the hub's turn puts them. Exits 1 where they are not, to rounding.
BEGIN { FS = ","; span = 0.1; radius = 0.15 }
FNR == NR || FNR == 1 { next }
function size(x) { return x < 0 ? -x : x }
{
    lines++
    do { # a heading, then a line a step
        if ((getline line < "hub.txt") <= 0) exit 1
    } while (line ~ /^#/)
    split(line, own, " ") # nine columns each: hub, three tips, three roots
    x = y = 0
    for (i = 0; i < 4; i++) { x += own[13 + 9 * i]; y += own[14 + 9 * i] }
    off = size($8 * span - x) + size($9 * span - y); if (off > worst) worst = off
    if (size(x) > most) most = size(x)
    for (i = 0; i < 3; i++) chord[i] = sqrt(own[43 + 9 * i] ^ 2 + own[44 + 9 * i] ^ 2)
    off = size(chord[0] - chord[1]) + size(chord[0] - chord[2]); if (off > apart) apart = off
    turn = 2 * atan2(chord[0], sqrt(4 * radius ^ 2 - chord[0] ^ 2))
    if (turn > farthest) farthest = turn
}
END {
    printf "  %-42s %.1e of the largest %.4g N (at most 1e-8)\n", "members' loads off the flow's force", worst / most, most
    printf "  %-42s %.1e m (at most 1e-9), with turns of the hub to %.4g rad\n", "blades' roots off the hub", apart, farthest
    exit !(lines > 0 && most > 1e-3 && worst < 1e-8 * most && farthest > 1e-2 && apart < 1e-9)
}
