# A public header as a table, for the scripts that write it in other languages; fields are parted by tabs:
#   constants  NAME=number ...                           of one enumeration
#   call  name  int|text|none  name|type|pass|shape ...  and its parameters
#   collective  name                                     whose comment has the word "Collective"; the others are local
# type: int, int64_t, double, float, char, context, the callback's or the handle's (session, member, ...). pass: value, in or out
# (by address), list (of handles, in), callback. shape: [n][3], "" of a single number.
# Whether an address is an array's, the comment before the call says, which must describe each of them: "x[nodes][3]: out" is one,
# "t: out" a single number. A size is a number, a constant, an argument of the call, or a count that COUNTS names. A capacity has the
# constant that counts its entries: "report[capacity]: out, by SPAR_REPORT_*".
# With -v null=1 each parameter has a fifth part: null, where its comment says what NULL means; of a count that no array need show, its
# word: "n: in, motion_nodes"; of a capacity that without which the array would be cut: "capacity: in, of the arrays; n is enough".
# With -v docs=1 each call is followed by:
#   doc  name  the comment before it, a backslash and an n between its lines
#   awk -f interface.awk <header>

# What a comment says of its parameters.
function hear(said,   list, n, word, i, p, own) {
    split("", SHAPE); split("", NULL); split("", WORD)
    gsub(/[ \t\n]+/, " ", said)
    while (match(said, LIST)) {
        list = substr(said, RSTART + 1, RLENGTH - 1)
        said = substr(said, RSTART + RLENGTH)
        own = said
        if (match(own, LIST)) own = substr(own, 1, RSTART)
        n = split(substr(list, 1, index(list, ": ") - 1), word, ", ")
        for (i = 1; i <= n; i++) {
            p = word[i]
            sub(/\[.*/, "", p)
            SHAPE[p] = substr(word[i], length(p) + 1)
            if (list ~ /: out$/ && own ~ /^, (m, rad, )?by SPAR_/) SHAPE[p] = counted(SHAPE[p], own)
            NULL[p] = own ~ /NULL( or 0)?:/
            if (match(own, /^, [a-z]+_nodes[,. *]/)) WORD[p] = substr(own, 3, RLENGTH - 3)
            if (match(own, /[a-z0-9]+ is enough/)) WORD[p] = substr(own, RSTART, RLENGTH - 10)
        }
    }
}

# "[capacity]" by "SPAR_REPORT_*"
function counted(shape, said,   by) {
    sub(/^[^S]*/, "", said)
    while (match(said, /^SPAR_[A-Z_]+\*/)) {
        by = substr(said, 1, RLENGTH - 1) "COUNT"
        said = substr(said, RLENGTH + 1)
        sub(/\[[a-z]+\]/, "[" by "]", shape)
        if (!sub(/^ and /, "", said)) break
    }
    return shape
}

function constants(body,   i, n, entry, side, value, line) {
    n = split(body, entry, ",")
    line = "constants"
    value = -1
    for (i = 1; i <= n; i++) {
        gsub(/[ \t]/, "", entry[i])
        if (entry[i] == "") continue
        value = split(entry[i], side, "=") == 2 ? side[2] : value + 1
        line = line "\t" side[1] "=" value
    }
    print line
}

# "const double g[3]" as "g|double|in|[3]"; the_name: "g"
function parameter(text,   type, p, stars, list, shape, fixed) {
    gsub(/^ +| +$/, "", text)
    list = text ~ /\*const \*/
    fixed = text ~ /^const /
    stars = gsub(/\*/, " ", text)
    shape = ""
    if (match(text, /\[[^]]*\]/)) {
        shape = substr(text, RSTART, RLENGTH)
        sub(/\[.*/, "", text)
        stars++
    }
    p = text
    sub(/.* /, "", p)
    the_name = p
    type = substr(text, 1, length(text) - length(p))
    gsub(/const /, "", type)
    gsub(/ +/, "", type)
    if (type == "void") return p "|context|value|"
    if (type in CALLBACK) return p "|" substr(type, 6) "|callback|"
    if (sub(/^spar_/, "", type)) return p "|" type "|" (list ? "list|" SHAPE[p] : stars > 1 ? "out|" : "value|")
    if (!stars) return p "|" type "|value|"
    if (!(p in SHAPE)) wrong(p " is not described: \"" p ": in\" or \"" p ": out\"")
    if (shape == "") shape = SHAPE[p]
    check_sizes(p, shape)
    if (type == "char" && shape == "") shape = "[]"
    return p "|" type "|" (fixed ? "in" : "out") "|" shape
}

function wrong(why) {
    print FILENAME ": " f ": " why >"/dev/stderr"
    failed = 1
}

# Every size of an array is one that a caller knows.
function check_sizes(p, shape,   k, part, i) {
    gsub(/^\[|\]$/, "", shape)
    k = split(shape, part, /\]\[/)
    for (i = 1; i <= k; i++)
        if (part[i] !~ /^[0-9]+$|^SPAR_[A-Z_]+_COUNT$/ && !(part[i] in ARGUMENT) && index(COUNTS, " " part[i] " ") == 0)
            wrong("the size of " p ", " part[i] ", is neither an argument nor a count")
}

function call(prototype,   head, answer, n, i, part, line, p) {
    head = prototype
    sub(/\(.*/, "", head)
    f = head
    sub(/.*[ *]/, "", f)
    answer = substr(head, 1, length(head) - length(f))
    line = "call\t" f "\t" (answer ~ /void/ ? "none" : answer ~ /\*/ ? "text" : "int")
    sub(/^[^(]*\(/, "", prototype)
    sub(/\)[^)]*$/, "", prototype)
    n = prototype == "void" ? 0 : split(prototype, part, ",")
    split("", ARGUMENT)
    for (i = 1; i <= n; i++)
        if (part[i] !~ /[*[]/) {
            p = part[i]
            sub(/.* /, "", p)
            ARGUMENT[p] = 1
        }
    for (i = 1; i <= n; i++) {
        line = line "\t" parameter(part[i])
        if (null) line = line "|" (part[i] ~ /[*[]/ ? (NULL[the_name] ? "null" : "") : WORD[the_name])
    }
    print line
    if (collective) print "collective\t" f
    if (docs) print "doc\t" f "\t" comment
}

BEGIN { LIST = " [a-z_][a-z0-9_]*([[][^]]*[]])*(, [a-z_][a-z0-9_]*([[][^]]*[]])*)*: (in|out)" }
BEGIN { COUNTS = " nodes motion_nodes force_nodes which_nodes sections blades P " }
BEGIN { split("spar_log spar_fluid_solver spar_before_step spar_progress", names, " "); for (i in names) CALLBACK[names[i]] = 1 }
/^#/ || /^extern "C"/ { next }
{ text = text $0 "\n" }

# Comments and statements in turn.
END {
    while (text != "") {
        sub(/^[ \t\n]+/, "", text)
        if (substr(text, 1, 2) == "/*") {
            stop = index(text, "*/")
            hear(" " substr(text, 1, stop + 1))
            collective = substr(text, 1, stop + 1) ~ /Collective/
            comment = substr(text, 4, stop - 5)
            gsub(/\\/, "\\\\", comment)
            gsub(/\n   /, "\\n", comment)
            gsub(/\n/, "\\n", comment)
            text = substr(text, stop + 2)
            continue
        }
        while ((stop = index(text, "/*")) && stop < index(text, ";")) # a comment within the statement
            text = substr(text, 1, stop - 1) substr(text, stop + 1 + index(substr(text, stop), "*/"))
        stop = index(text, ";")
        if (!stop) break
        statement = substr(text, 1, stop - 1)
        text = substr(text, stop + 1)
        gsub(/[ \t\n]+/, " ", statement)
        if (statement ~ /enum \{/) {
            sub(/.*\{/, "", statement)
            sub(/\}.*/, "", statement)
            constants(statement)
        } else if (sub(/.*SPAR_API /, "", statement)) {
            call(statement)
        }
    }
    if (failed) exit 1
}
