# What a run of the rotor gave: the last third of it in the mean. Exits 1 where forces or powers do not balance.
#
# Thrust and power of other models at 8 m/s, 9.16 rev/min: blade element momentum theory (rigid) 385 kN, 1.90 MW; the same
# blades behind AMR-Wind, cells of D/10, kernel 0.2 D, after 25 s 445 kN, 2.69 MW (a line on a coarse mesh gives too much).
BEGIN { FS = "," }
FNR == NR { split($0, word, " "); summary[word[1]] = word[2]; next }
FNR == 1 { next }
{
    lines++; for (i = 1; i <= 15; i++) x[lines, i] = $i
    line = sqrt($4 ^ 2 + $5 ^ 2 + $6 ^ 2); off = sqrt(($7 - $4) ^ 2 + ($8 - $5) ^ 2 + ($9 - $6) ^ 2) / line
    if (off > worst) worst = off
    if (least == "" || $12 < least) least = $12
    if ($13 > most) most = $13
    iterations += $15
}
END {
    if (lines != steps) { printf "  only %d of %d steps in history.csv\n", lines, steps; exit 1 }
    from = int(2 * lines / 3) + 1
    for (i = from; i <= lines; i++) for (k = 2; k <= 14; k++) mean[k] += x[i, k] / (lines - from + 1)
    printf "\n%s: %d steps of %g s\n", name, steps, dt
    printf "  %-46s %.2f in the mean\n", "iterations a step", iterations / lines
    printf "  %-46s %.2f %% of the processor time\n", "spar's share, aerodynamics included", 100 * summary["spar_share"]
    printf "  %-46s %.0f kN (momentum theory 385, AMR-Wind at 25 s 445)\n", "thrust", mean[2] / 1e3
    printf "  %-46s %.2f MW (momentum theory 1.90, AMR-Wind at 25 s 2.69)\n", "shaft power", mean[3] / 1e6
    printf "  %-46s %.1e of it (at most 1e-3)\n", "spread force off the line's", worst
    printf "  %-46s %.4f to %.4f of the integral\n", "the kernel's sum over cells, before scaling", least, most
    printf "  %-46s %.4f MW\n", "power taken from the flow", mean[11] / 1e6
    printf "  %-46s %.4f MW\n", "given to the moving blades by the line's force", mean[10] / 1e6
    printf "  %-46s %.4f MW, %.1f %% (drag)\n", "lost between them", (mean[11] - mean[10]) / 1e6, 100 * (1 - mean[10] / mean[11])
    printf "  %-46s %.2f m\n", "tip of blade 1 downwind", mean[14]
    if (!(worst < 1e-3) || mean[11] < mean[10] || mean[10] < 0.8 * mean[11]) exit 1
}
