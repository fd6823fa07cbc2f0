# SPDX-License-Identifier: Apache-2.0
# Writes the results of tests/bench/cycles/run as Markdown (md) and JSON (json). Input: lines of writeFigures.
function median(key, column,    n, i, j, values, t) {
    n = count[key]
    for (i = 1; i <= n; ++i) values[i] = figure[key, column, i]
    for (i = 2; i <= n; ++i)
        for (j = i; j > 1 && values[j] < values[j - 1]; --j) { t = values[j]; values[j] = values[j - 1]; values[j - 1] = t }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
}
# Square of the relative standard error of a mean. One figure has none.
function uncertainty(key, column,    i, n, average, sum) {
    n = count[key]; average = mean(key, column)
    if (n < 2 || average == 0) return 0
    for (i = 1; i <= n; ++i) sum += (figure[key, column, i] - average) ^ 2
    return sum / (n - 1) / n / average ^ 2
}
function mean(key, column,    i, sum) {
    for (i = 1; i <= count[key]; ++i) sum += figure[key, column, i]
    return sum / count[key]
}
# Median over the pairs of runs: the machine's speed changes with time.
function ratio(scene, release, column,    key, other, n, i, values, error) {
    key = scene SUBSEP "quintet"; other = scene SUBSEP release; pair = "pair" SUBSEP key SUBSEP other SUBSEP column
    error = mean(key, "error") / mean(other, "error")
    doubt = uncertainty(key, "error") + uncertainty(other, "error")
    count[pair] = count[key]
    for (i = 1; i <= count[key]; ++i) figure[pair, 0, i] = figure[key, column, i] / figure[other, column, i] * error
    doubt = sqrt(doubt + uncertainty(pair, 0)) # the relative standard error of the ratio
    return median(pair, 0)
}
function list(key, column,    i, text) {
    for (i = 1; i <= count[key]; ++i) text = text (i > 1 ? ", " : "") figure[key, column, i]
    return "[" text "]"
}
$1 == "settings" {
    machine = $2 ", " $3 " processors" ($4 > 1 ? ", " $4 " jobs at a time" : "")
    device = $5; commit = $6; references = $7; runs = $8
    next
}
$1 == "agreement" { flip[$2, $3] = $4; next }
$1 == "described" { scenes[++sceneCount] = $2; size[$2] = $3; spp[$2] = $4; bounces[$2] = $5; next }
$3 == "start" { start[$1, $2] = $4; next }
{
    key = $1 SUBSEP $2
    i = ++count[key]
    figure[key, "cpu", i] = $4; figure[key, "wall", i] = $5; figure[key, "error", i] = $6
}
END {
    n = split(labels, pairs, " ")
    for (i = 1; i <= n; ++i) { split(pairs[i], parts, "="); releases[i] = parts[1]; version[parts[1]] = parts[2] }
    header = "| scene | Quintet: s, relMSE (start) |"; rule = "| --- | --- |"
    for (i = 1; i <= n; ++i) {
        header = header " Cycles " version[releases[i]] ": s, relMSE (start) | ratio (wall clock) | FLIP |"
        rule = rule " --- | --- | --- |"
    }
    # Without references, the errors of few runs depend on each other too much to show how they scatter.
    known = runs > 1 && (references > 0 || runs > 3)
    how = references > 0 ? "references with " references " times the samples" : "error to the mean of all runs, corrected"
    print "Processor time, " machine ", " commit " on " device ", " runs " runs, " how ".\n" >md
    print header " against the better |\n" rule " --- |" >md
    printf "{\"machine\": \"%s\", \"device\": \"%s\", \"commit\": \"%s\", \"referenceFactor\": %d, \"scenes\": [", machine, device, \
        commit, references >json
    for (s = 1; s <= sceneCount; ++s) {
        scene = scenes[s]
        key = scene SUBSEP "quintet"
        printf "| %s, %s, %d spp, %d bounces | %.2f, %.3g (%.2f) |", scene, size[scene], spp[scene], bounces[scene], \
            median(key, "cpu"), mean(key, "error"), start[scene, "quintet"] >md
        printf "%s\n  {\"name\": \"%s\", \"size\": \"%s\", \"spp\": %d, \"bounces\": %d,\n    \"quintet\": {\"startSeconds\": %s, \"cpuSeconds\": %s, \"wallSeconds\": %s, \"relMse\": %s}", \
            (s > 1 ? "," : ""), scene, size[scene], spp[scene], bounces[scene], start[scene, "quintet"], list(key, "cpu"), \
            list(key, "wall"), list(key, "error") >json
        worst = 0
        for (i = 1; i <= n; ++i) {
            release = releases[i]; other = scene SUBSEP release
            wall = ratio(scene, release, "wall"); cpu = ratio(scene, release, "cpu")
            scatter = known ? sprintf(" ± %.2f", cpu * doubt) : ""
            if (cpu > worst) worst = cpu
            printf " %.2f, %.3g (%.2f) | **%.2f**%s (%.2f) | %.3f |", median(other, "cpu"), mean(other, "error"), \
                start[scene, release], cpu, scatter, wall, flip[scene, release] >md
            printf ",\n    \"cycles %s\": {\"startSeconds\": %s, \"cpuSeconds\": %s, \"wallSeconds\": %s, \"relMse\": %s, \"ratio\": %.4f, \"ratioStandardError\": %s, \"wallRatio\": %.4f, \"flip\": %s}", \
                version[release], start[scene, release], list(other, "cpu"), list(other, "wall"), list(other, "error"), cpu, \
                known ? sprintf("%.4f", cpu * doubt) : "null", wall, flip[scene, release] >json
        }
        printf " **%.2f** |\n", worst >md
        printf ",\n    \"ratioToBetter\": %.4f}", worst >json
    }
    print "\n]}" >json
}
