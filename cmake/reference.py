#!/usr/bin/env python3
"""The reference (docs/reference) from the sources: a page per public header, options, statuses, keys of a case file, messages.

  reference.py [folder]           writes the pages, default docs/reference
  reference.py --check [headers]  prints what is public and has no words, exits with 1 where there is any

A header's comment stands before what it describes, or behind it on its line. A prototype right under another shares its comment.
"""
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
HEADERS = "spar spar_structure spar_coupling spar_mpi spar_output spar_analysis spar_aero".split()
ARGUMENT = re.compile(r"( *)((?:[a-z_]\w*(?:\[[^]]*\])*)(?:, [a-z_]\w*(?:\[[^]]*\])*)*): (.*)")

KEY = re.compile(r"([a-z]+(?:[._][a-z_]+)*)(?:   *(?= )| (?=\S+ \(default\) \| )) *(\S.*)")  # a key of an option and what it is


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def words_of(comment):
    """The text of a comment, without its frame and the indentation of its lines."""
    lines = comment[2:-2].strip(" ").split("\n")
    return "\n".join([lines[0].strip()] + [re.sub("^   ", "", line).rstrip() for line in lines[1:]]).strip("\n")


class Header:
    """items: (kind, name, declaration, comment) with kind part, text, call, type or enum."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.name, self.items, self.bare, self.intro = os.path.basename(path), [], [], ""
        self.public = 0
        self.parse()

    def parse(self):
        comment, last, blank, pos = "", "", True, 0
        token = re.compile(r"/\*.*?\*/|static inline [^{]*\{.*?\n\}|\n[ \t]*\n|\n?#(?:[^\n]|\\\n)*|extern \"C\" \{|\n\}|[^;{]*\{[^}]*\}[^;]*;[^\n]*|[^;]*;[^\n]*", re.S)
        while pos < len(self.text):
            if self.text[pos] == "\n" and self.text[pos + 1 : pos + 2] not in "\n#}":
                pos += 1
                continue
            m = token.match(self.text, pos)
            if not m:
                break
            piece, pos = m.group(0), m.end()
            if piece.startswith("/*"):
                self.remark(comment)
                comment = piece
            elif re.match(r"\n[ \t]*\n", piece):
                self.remark(comment)
                comment, blank = "", True
                pos -= 1
            elif piece.lstrip().startswith("#") or piece.startswith("extern") or piece == "\n}":
                self.remark(comment)
                comment, blank = "", True
            else:
                last = self.declare(piece.strip("\n"), comment, "" if blank else last)
                comment, blank = "", False
        self.remark(comment)

    def remark(self, comment):
        if not comment:
            return
        title = re.match(r"/\* -{4} (.*?) -+(?: \*/|\n)", comment)
        if title:
            self.items.append(("part", title.group(1), "", words_of("/*" + comment[title.end() :]) if comment[title.end() :].strip(" */") else ""))
        elif not self.intro and not self.items:
            self.intro = words_of(comment)
        else:
            self.items.append(("text", "", "", words_of(comment)))

    def declare(self, piece, comment, shared):
        own = words_of(comment) if comment else ""
        if re.match(r"(typedef )?enum", piece):
            self.enumeration(piece, own)
            return ""
        behind = re.search(r"/\*.*?\*/", piece, re.S)
        declaration = re.sub(r"\s*/\*.*?\*/", "", piece, flags=re.S).replace("SPAR_API ", "")
        declaration = re.sub(r"(?s)(static inline .*?) \{.*", r"\1;", declaration)
        if "typedef struct" in piece:
            name, own = re.search(r"(\w+);", declaration).group(1), words_of(behind.group(0)) if behind else own
            self.add("type", name, declaration, own)
            return ""
        name = re.search(r"\(\*(\w+)\)|(\w+)\(", declaration)
        self.add("type" if "typedef" in piece else "call", name.group(1) or name.group(2), declaration, own or shared)
        return own or shared

    def add(self, kind, name, declaration, comment):
        self.public += 1
        if not comment:
            self.bare.append(name)
        self.items.append((kind, name, declaration, comment))

    def enumeration(self, piece, own):
        rows = re.findall(r"(SPAR_\w+) *= *(\w+),?(?:\s*/\*(.*?)\*/)?", piece, re.S)
        self.public += len(rows)
        for name, _, said in rows:
            if not said and not own:
                self.bare.append(name)
        self.items.append(("enum", rows[0][0], [(n, v, re.sub(r"\s+", " ", s).strip()) for n, v, s in rows], own))

    def calls(self):
        return [(name, declaration, comment) for kind, name, declaration, comment in self.items if kind == "call"]


# ---- text of comments as Markdown

HOME = {}  # call, type or constant -> page and anchor


def span(text, own=""):
    """Escapes what Markdown would read, and links the names that the library has."""

    def name(m):
        word = m.group(0)
        return f"[`{word}`]({HOME[word]})" if word in HOME and word != own else f"`{word}`"

    out, pos = "", 0
    for m in re.finditer(r"\b(?:spar_[a-z0-9_]*[a-z0-9](?:\.h)?|SPAR_[A-Z0-9_]*[A-Z0-9](?:_\*)?|NULL)\b\*?|\bdocs/\S+\.md", text):
        out += escaped(text[pos : m.start()])
        word = m.group(0)
        if word.startswith("docs/"):
            out += f"[{os.path.basename(word)}]({os.path.relpath(word, 'docs/reference')})"
        else:
            out += name(m)
        pos = m.end()
    return out + escaped(text[pos:])


def escaped(text):
    return re.sub(r"([\\<>*_|`#\[\]$~])", r"\\\1", text)


def first_sentence(comment):
    text = re.sub(r"\s+", " ", comment)
    m = re.match(r"(?:[^.(]|\([^)]*\)|\.(?! ))*[.:](?= |$)", text)
    return (m.group(0) if m else text).rstrip(":.") + "."


def purpose(name, comment):
    if ARGUMENT.match(comment.split("\n")[0]) or comment.startswith("Outputs:"):
        setter = name.replace("_get_", "_set_")
        if setter in HOME and setter != name:
            return f"Answers what {span(setter)} has set."
        said = re.sub(r"\s+", " ", comment)
        said = re.sub(r"^[a-z_]\w*(\[[^]]*\])*: (in|out)(, )?", "", said) if said.count(": out") + said.count(": in") < 2 else ""
        trivial = re.match(r"$|(Local|Collective|SPAR_\w+\*?)\b", said.lstrip(" ,."))
        return span(first_sentence(said[0].upper() + said[1:])) if not trivial else "Answers " + ", ".join(
            f"`{n}`" for n in re.findall(r"([a-z_]\w*)(?:\[[^]]*\])*: out", comment)) + "."
    return span(first_sentence(comment))


def markdown(comment, own=""):
    """A comment as paragraphs, lists of arguments and keys, and code."""
    out, block, kind = [], [], ""

    def flush():
        nonlocal block, kind
        if block and kind == "code":
            out.append("```c\n" + "\n".join(line[7:] for line in block) + "\n```")
        elif block and kind == "list":
            out.append("\n".join("- " + " ".join(item) for item in block))
        elif block:
            out.append(" ".join(block))
        block, kind = [], ""

    for line in comment.split("\n"):
        argument = ARGUMENT.match(line)
        key = KEY.match(line)
        if not line.strip():
            if kind != "code":
                flush()
            else:
                block.append("")
        elif re.match(r"    \S.*(;|\{)( |$)|    }|    do \{|        ", line) and kind in ("", "code") or kind == "code" and line.startswith("    "):
            kind = "code"
            block.append("   " + line)
        elif argument and re.match(r"(in|out|from|SPAR|what|callback)\b", argument.group(3)):
            if kind != "list":
                flush()
            kind = "list"
            block.append([f"`{argument.group(2)}`: " + span(argument.group(3), own)])
        elif key:
            if kind != "list":
                flush()
            kind = "list"
            block.append([f"`{key.group(1)}`: " + span(key.group(2), own)])
        elif re.match(r" *(- |\d  )", line):
            if kind != "list":
                flush()
            kind = "list"
            block.append([span(re.sub(r"^ *(- |\d  )", "", line), own)])
        elif kind == "list" and line.startswith("  "):
            block[-1].append(span(line.strip(), own))
        else:
            if kind != "text":
                flush()
            kind = "text"
            block.append(span(line.strip(), own))
    flush()
    return "\n\n".join(out)


# ---- pages

MADE = "<!-- written by cmake/reference.py -->\n"
OBJECTS = "version session step member point rigid beam section joint spring link fluid trial vtk aero".split()


SUBJECTS = {
    "spar": "sessions, steps, members, fluids",
    "spar_structure": "sections, beams, loads, modes, joints",
    "spar_coupling": "integrator, coupling, added mass, step size, ranks",
    "spar_mpi": "a session on an MPI communicator",
    "spar_output": "files for ParaView",
    "spar_analysis": "trials, advice, flutter, periodic states",
    "spar_aero": "blade elements",
}


def object_of(name):
    word = name.split("_")[1]
    return word if word in OBJECTS else "library"


def header_page(header):
    out = [MADE + f"# {header.name}: {SUBJECTS[header.name[:-2]]}", markdown(re.sub(r"^\w+\.h: (\w)", lambda m: m.group(1).upper(), header.intro)), "## Calls by object"]
    groups = {}
    for name, _, comment in header.calls():
        groups.setdefault(object_of(name), []).append(f"| {span(name)} | {purpose(name, comment)} |")
    for group in sorted(groups, key=lambda g: (OBJECTS + ["library"]).index(g)):
        out.append(f"| {group} | purpose |\n|---|---|\n" + "\n".join(groups[group]))
    last = None
    for kind, name, declaration, comment in header.items:
        if kind == "part":
            out.append(f"## {name[0].upper()}{name[1:]}")
        if kind in ("part", "text"):
            out.append(markdown(comment))
        elif kind == "enum":
            out.append(f"### `{prefix(declaration)}`")
            out.append(markdown(comment))
            out.append("| constant | number | meaning |\n|---|--:|---|\n" + "\n".join(
                f"| `{n}` | {v} | {span(s) if s else 'number of constants of this kind' if n.endswith('_COUNT') else ''} |" for n, v, s in declaration))
        else:
            out.append(f"### `{name}`")
            out.append("```c\n" + declaration.strip() + "\n```")
            shared = comment == last and kind == "call"
            out.append("As above." if shared else markdown(comment, name))
            last = comment
    return "\n\n".join(part for part in out if part) + "\n"


def prefix(rows):
    names = [n for n, _, _ in rows if not n.endswith("_COUNT")]
    if names[0] == "SPAR_OK":
        return "SPAR_OK, SPAR_ERR_*"
    common = os.path.commonprefix(names) if len(names) > 1 else names[0]
    common = common[: common.rfind("_") + 1] if len(names) > 1 else common
    return common + ("*" if len(names) > 1 else "")


def option_texts(headers):
    """What the headers say of each key of an option, and of each argument of a setter."""
    said = {}
    for header in headers:
        for name, _, comment in header.calls():
            if name.endswith("_set_option"):
                key = ""
                for line in comment.split("\n"):
                    m = KEY.match(line)
                    if m:
                        key = m.group(1)
                        said[key] = m.group(2)
                    elif key and line.startswith("    "):
                        said[key] += " " + line.strip()
                    else:
                        key = ""
            elif "_session_set_" in name:
                argument = ""
                for line in comment.split("\n"):
                    m = ARGUMENT.match(line)
                    if m:
                        argument = m.group(2).split("[")[0]
                        said[name, argument] = m.group(3)
                    elif argument and line.startswith("      "):
                        said[name, argument] += " " + line.strip()
                    else:
                        argument = ""
    return said


def short(number):
    return {"DBL_MAX": "", "SPAR_COUPLING_IQN_ILS": "`SPAR_COUPLING_IQN_ILS`"}.get(number, number)


def options_page(headers):
    said = option_texts(headers)
    source = read("src/session/settings.c")
    table = source[source.index("static const spari_setting settings[]") : source.index("enum { SETTINGS")]
    ranges = dict(re.findall(r'(\w+)\[\] = "([^"]*)"', source))
    rows = re.findall(r'\n    ([A-Z_]+)\(((?:"[^"]*"|[^()"])*)\)', table)
    setters, options = [], []
    for macro, arguments in rows:
        a = [x.strip() for x in re.findall(r'(?:"[^"]*"|[^,])+', arguments)]
        a = [x[1:-1] if x.startswith('"') else ranges.get(x, x) for x in a]
        if macro in ("REAL", "WHOLE"):
            call = "spar_session_set_" + a[1]
            setters.append((call, a[2], a[6], short(a[7]), said.get((call, a[2]), "")))
        elif macro == "ALONG" and "(x)" in a[0]:
            setters.append(("spar_session_set_gravity", "g", "finite numbers", "0, 0, 0", said["spar_session_set_gravity", "g"]))
        elif macro in ("OPTION_REAL", "OPTION_WHOLE"):
            options.append((a[0], a[4], a[5], said[a[0]]))
        elif macro == "OPTION_WORD":
            options.append((a[0], f"{a[2]} or {a[3]}", a[2], said[a[0]]))
    fluid = read("src/fluid/options.c")
    fluids = [(k, f"{zero} or {one}", zero, said[k]) for k, zero, one in re.findall(r'FLUID_WORD\("([^"]*)", \w+, "(\w+)", "(\w+)"\)', fluid)]
    fluids += [(k, "a finite number, s", "0", said[k]) for k in re.findall(r'FLUID_REAL\("([^"]*)"', fluid)]
    if len(setters) < 15 or len(options) < 10 or len(fluids) < 6:
        sys.exit(f"reference.py: the tables of settings are read wrongly: {len(setters)}, {len(options)}, {len(fluids)}")
    def clean(text, otherwise=""):
        """What is said of a setting, less its default and its range, which have their own columns."""
        text = re.sub(r"^[^:;]*default[^:;]*: |^(in|out)(, )?|^0 \(default\) \| ", "", text)
        text = re.sub(r"[;,] default (?:[^;.,:]|\.\d)*", "", text)
        text = re.sub(r",? (>= \d|in [\[(]\d,\d\])(?=[;.]|$)|^(>= \d|0 to 1|SPAR_COUPLING_\*|1 or 0 \(default\))[;,.]? ?|^0, 1 \(default\) or 2\. ", "", text.strip())
        text = re.sub(r"^(N|m)(,? ?>= 0)?(, and)?$", r"\1", text.strip(" .;"))
        return span(text if len(text.split()) > 1 else (otherwise + (f" ({text})" if text else "")))

    first = {name: first_sentence(comment).rstrip(".") for h in headers for name, _, comment in h.calls()}
    first["spar_session_set_coupling"] = "Coupling scheme and its stop test"
    table = lambda head, rows: head + "\n" + "|---" * head.count("|", 1) + "|\n" + "\n".join(rows)
    return "\n\n".join([
        MADE + "# Options and settings, with defaults and ranges",
        "A setting that is not made has its default. Settings of a session are made between steps, with the same values on every rank. "
        "A value out of range is refused with `SPAR_ERR_ARGUMENT`, and nothing changes.",
        "## Settings of a session by call",
        table("| call: argument | default | range | meaning |",
              [f"| {span(c)}: `{n}` | {d} | {span(r)} | {clean(t, first[c])} |" for c, n, r, d, t in setters]),
        "## Options of a session by name",
        f"{span('spar_session_set_option')} takes a key and a value, both as text. "
        f"{span('spar_session_get_option')} answers the value.",
        table("| key | default | range | meaning |", [f"| `{k}` | {d} | {r} | {clean(t, 'absolute part, see coupling.motion_rtol')} |" for k, r, d, t in options]),
        "## Options of a fluid by name",
        f"{span('spar_fluid_set_option')} takes a key and a value, both as text. The options of a fluid concern the nodes of one rank.",
        table("| key | default | range | meaning |", [f"| `{k}` | {d} | {r} | {clean(t)} |" for k, r, d, t in fluids]),
    ]) + "\n"


CURES = {
    "SPAR_OK": "nothing",
    "SPAR_ERR_ARGUMENT": "correct the argument that the message names; nothing has changed",
    "SPAR_ERR_STATE": "make the calls in order; the message names the missing one",
    "SPAR_ERR_MEMORY": "use fewer nodes, columns or a smaller history; nothing has changed",
    "SPAR_ERR_NUMERIC": "reject the step, then choose a smaller dt or another coupling scheme",
    "SPAR_ERR_MAPPING": "look at the positions of the nodes, or at `spar_fluid_set_projection`",
    "SPAR_ERR_COMM": "make the same calls with the same arguments on all ranks",
    "SPAR_ERR_PEER": "read the message: it is that of the rank that failed",
    "SPAR_ERR_IO": "look at the path, the permissions and the version of the file",
    "SPAR_ERR_UNSUPPORTED": "choose another fidelity, or a build with the feature (`spar_has`)",
    "SPAR_ERR_USER": "look at the callback: it has answered something other than 0",
    "SPAR_ERR_LIMIT": "continue, or allow more work",
}


def statuses_page(headers):
    rows = next(d for h in headers for k, n, d, _ in h.items if k == "enum" and n == "SPAR_OK")
    out = [MADE + "# Statuses: what each error means and what to do",
           "Every call answers a status, except destroys and calls that answer a text. `spar_session_message` says what is wrong, "
           "where, and what to do. [messages.md](messages.md) lists all messages. The numbers never change.",
           "| status | number | meaning | what to do |\n|---|--:|---|---|\n" + "\n".join(
               f"| `{n}` | {v} | {span(s) or 'no error'} | {span(CURES[n].replace('`', ''))} |" for n, v, s in rows),
           "Every call may answer `SPAR_ERR_ARGUMENT` (NULL, not finite, out of range), `SPAR_ERR_STATE` (out of order) and "
           "`SPAR_ERR_MEMORY`. A collective call may answer `SPAR_ERR_COMM` and `SPAR_ERR_PEER`. The tables below list what calls answer in particular."]
    for status, _, _ in rows[1:]:
        found = []
        for h in headers:
            for name, _, comment in h.calls():
                text = re.sub(r"\s+", " ", comment)
                for m in re.finditer(status + r"(?: and SPAR_\w+)?: ((?:[^.;]|\.(?! |$))*)", text):
                    found.append(f"| {span(name)} | {span(m.group(1))} |")
        if found:
            out.append(f"## `{status}`\n\n| call | when |\n|---|---|\n" + "\n".join(dict.fromkeys(found)))
    return "\n\n".join(out) + "\n"


def case_page():
    source = read("examples/hosts/common/case_keys.c")
    keys = {}
    for name, body in re.findall(r"known_key (\w+)\[\] = \{\n(.*?)\n\};", source, re.S):
        keys[name] = re.findall(r'\{"(\w+)", \d+, \d+, (\d),\s*"([^"]*)"', body)
    out = [MADE + "# Case files: all headings and keys",
           "A case file describes a structure, its coupling, its blade elements and its output. `spar-run` and all adapters of "
           "[examples/hosts](../../examples/hosts) read it. `spar-run --explain` prints these tables. "
           "[spar-run.md](spar-run.md) has an example; [examples/hosts/cases](../../examples/hosts/cases) has more.",
           "A line is a heading in brackets, or a key and its values. `#` begins a comment. Units are SI. A key that is not known is refused, with the nearest one. "
           "Keys of `[session HOST]` hold for one host alone. The keys of `[host ...]` are those of the host, and its own page lists them."]
    for kind, naming, first, second in re.findall(r'\{"(\w+)", (NAME_\w+), \{(\w+), (\w+)\}\}', source):
        if first == "NULL":
            continue
        rows = keys[first] + (keys.get(second, []))
        out.append(f"## `[{kind}{' NAME' if naming == 'NAME_OWN' else ''}]`")
        out.append("| key | values, units, default | lines |\n|---|---|---|\n" + "\n".join(
            f"| `{name}` | {span(text)} | {'any number' if many == '1' else 'one'} |" for name, many, text in rows))
    return "\n\n".join(out) + "\n"


# ---- messages

def formats(source):
    """(position, text) of the texts with three words or more, adjacent literals joined, comments left out."""
    source = re.sub(r'("(?:[^"\\\n]|\\.)*")|/\*.*?\*/', lambda m: m.group(1) or re.sub(r"[^\n]", " ", m.group(0)), source, flags=re.S)
    source = re.sub(r'(?m)^#include.*$', "", source)
    for m in re.finditer(r'"(?:[^"\\\n]|\\.)*"(?:\s*(?:PRI\w+\s*)?"(?:[^"\\\n]|\\.)*")*', source):
        text = re.sub(r'"\s*(?:PRI\w+\s*)?"', "", m.group(0))[1:-1]
        yield source[: m.start()], text


def readable(text):
    text = re.sub(r"%[-+ 0#]*(?:\d+|\*)?(?:\.(?:\d+|\*))?(?:ll|l|z|h)?[dugeif]", "N", text)
    text = re.sub(r"%(?:\.(?:\d+|\*))?[sc]", "…", text).replace("%%", "%").replace('\\"', '"').replace("\\n", " ")
    return re.sub(r"^…: ", "", text).strip()


def messages_page():
    found = {}
    for folder in ("src", "examples/hosts/common"):
        for path in sorted(os.path.join(d, f) for d, _, files in os.walk(os.path.join(ROOT, folder)) for f in files if f.endswith((".c", ".h"))):
            if path.endswith("/case_keys.c"):
                continue
            for before, text in formats(read(path)):
                opened = before[max(before.rfind(";"), before.rfind("}\n")) + 1 :]
                called = re.search(r"(\w*(?:REQUIRE|FAIL|fail|warn|refuse)\w*|snprintf|say|report)\s*\(", opened)
                plain = readable(text)
                if not (called or re.search(r"return |=|\? |: |, $", opened)) or "fprintf" in opened or len(plain.split()) < 3:
                    continue
                if len(re.findall(r"[A-Za-z]{2,}", plain)) < 2 or re.search(r"^#|^</|option .*\(1: ", plain) or path.endswith("settings.c") and not called:
                    continue
                status = re.findall(r"SPAR_ERR_\w+", opened)
                kind = "warning" if "spari_warn" in opened else f"`{status[-1]}`" if status and called else ""
                found.setdefault(plain, (set(), set()))
                found[plain][0].add(kind)
                found[plain][1].add(os.path.relpath(path, ROOT).replace("src/", "", 1))
    order = sorted(found, key=lambda text: re.sub(r"^\W*", "", text).lower())
    row = lambda text: f"{escaped(text)} | {', '.join(f'`{p}`' for p in sorted(found[text][1]))} |"
    return "\n\n".join([
        MADE + "# Messages, sorted",
        "A message says what is wrong, where, and what to do. It begins with the call that failed, which is left out here. `N` stands for a number, "
        "`…` for a name or a text. [statuses.md](statuses.md) explains the statuses.",
        "| status | message | source |\n|---|---|---|\n" + "\n".join(
            f"| {', '.join(sorted(found[text][0] - {''}))} | " + row(text) for text in order if found[text][0] - {""}),
        "## Parts of messages, and lines of the log",
        "| text | source |\n|---|---|\n" + "\n".join("| " + row(text) for text in order if not found[text][0] - {""})]) + "\n"


def main():
    arguments = sys.argv[1:]
    check = arguments[:1] == ["--check"]
    where = arguments[1] if check and len(arguments) > 1 else os.path.join(ROOT, "include/spar")
    headers = [Header(os.path.join(where, name + ".h")) for name in HEADERS]
    if check:
        bare = [f"{h.name}: {name} has no words" for h in headers for name in h.bare]
        public = sum(h.public for h in headers)
        print("\n".join(bare) or f"{public} public names have words")
        sys.exit(1 if bare or public < 400 else 0)
    for h in headers:
        page = h.name[:-2] + ".md"
        for kind, name, declaration, _ in h.items:
            if kind in ("call", "type"):
                HOME[name] = f"{page}#{name}"
            elif kind == "enum":
                slug = re.sub(r"[^a-z0-9 _-]", "", prefix(declaration).lower()).replace(" ", "-")
                HOME.update({n: f"{page}#{slug}" for n, _, _ in declaration})
        HOME[h.name] = page
    out = arguments[0] if arguments else os.path.join(ROOT, "docs/reference")
    os.makedirs(out, exist_ok=True)
    pages = {h.name[:-2]: header_page(h) for h in headers}
    pages.update({"options": options_page(headers), "statuses": statuses_page(headers), "case-file": case_page(), "messages": messages_page()})
    for name, text in pages.items():
        with open(os.path.join(out, name + ".md"), "w", encoding="utf-8") as file:
            file.write(text)
    print(f"{len(pages)} pages of the reference")


if __name__ == "__main__":
    main()
