#!/usr/bin/env python3
"""The documents as one book to be browsed without a network: pages of docs/, the READMEs, the sources that they name.

  book.py <folder>    writes <folder>/html. Needs pandoc.

Equations become MathML. A call in `code` leads to its page of the reference, a path to the source. Search runs in the browser. An error is: a
link that leads nowhere, Markdown or TeX that is left as it stands, a document that no chapter has.
"""
import concurrent.futures
import glob
import html
import html.parser
import json
import os
import posixpath
import re
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CHAPTERS = [  # the order of reading; a pattern takes what is not taken before
    ("Start", ["docs/README.md", "README.md", "docs/languages.md", "docs/problems.md", "docs/coming-from.md"]),
    ("Tutorial", ["docs/tutorial/README.md", "docs/tutorial/*.md"]),
    ("How to", ["docs/howto/README.md", "docs/howto/*.md", "docs/hosts.md", "docs/faq.md"]),
    ("Explanation", ["docs/explanation/accuracy.md", "docs/explanation/coupling.md", "docs/explanation/advice.md", "docs/explanation/effects.md",
                     "docs/explanation/transfer.md", "docs/explanation/projection.md", "docs/explanation/stability.md",
                     "docs/explanation/theory.md", "docs/explanation/[!a]*.md"]),
    ("Reference", ["docs/reference/README.md", "docs/reference/spar.md", "docs/reference/spar_structure.md", "docs/reference/spar_coupling.md",
                   "docs/reference/spar_output.md", "docs/reference/spar_mpi.md", "docs/reference/spar_analysis.md", "docs/reference/spar_aero.md",
                   "docs/reference/options.md", "docs/reference/statuses.md", "docs/reference/messages.md", "docs/reference/*.md"]),
    ("Evidence", ["docs/evidence/verification.md", "docs/evidence/*.md"]),
    ("Examples", ["docs/examples/*.md", "examples/hosts/*/README.md", "python/README.md"]),
    ("Changing spar", ["CONTRIBUTING.md", "src/README.md", "docs/explanation/architecture.md", "docs/explanation/adding.md", "docs/*.md",
                       "cmake/packaging/README.md", "CHANGELOG.md"]),
]
SOURCES = (".c", ".h", ".f90", ".py", ".case", ".awk", ".gp", ".sh", ".polar", ".map", ".cmake", ".in", ".toml", ".csv", "")


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True, check=True).stdout


def tracked():
    """The files of the repository, or of a released archive."""
    try:
        found = set(git("ls-files").split("\n")) - {""}
    except (OSError, subprocess.CalledProcessError):
        found = set()
    if "CMakeLists.txt" not in found:
        every = (os.path.relpath(os.path.join(d, f), ROOT) for d, _, files in os.walk(ROOT) for f in files)
        found = {p for p in every if not re.match(r"build|\.git/|.*__pycache__", p)}
    return found


def raised(text):
    """Exponents: t^n, t^{n+1}, s^2, S^-1/2, R^T."""
    return re.sub(r"(?<=[\w)])\^(?:\{([^}]*)\}|(-1/2|-?\d+|n|T)\b)", lambda m: f"<sup>{m.group(1) or m.group(2)}</sup>", text)


GREEK = dict(zip("alpha beta gamma theta kappa lambda xi rho sigma tau phi psi omega mu eps Omega Phi".split(), "αβγθκλξρστφψωμεΩΦ"))


def symbols(text):
    """Greek letters and indices in a text with formulas."""
    text = re.sub(r"\brho_inf\b", "ρ<sub>∞</sub>", text)
    text = re.sub(r"(?<![A-Za-z])(" + "|".join(GREEK) + r")(?![A-Za-z])", lambda m: GREEK[m.group(1)], text)
    return re.sub(r"(?<![\w>])([A-Za-zαβγθκλξρστφψωμεΩΦ])_([A-Za-z0-9]{1,2}|map)(?![\w(])", r"\1<sub>\2</sub>", text)


class Book:
    def __init__(self, out):
        self.out = os.path.join(out, "html")
        self.files = tracked()
        self.chapters, self.pages, self.faults = [], {}, []  # pages: document -> file of the book
        self.sources, self.titles, self.index = {}, {}, []
        for title, patterns in CHAPTERS:
            documents = []
            for pattern in patterns:
                found = sorted(os.path.relpath(p, ROOT) for p in glob.glob(os.path.join(ROOT, pattern)))
                documents += [p for p in found if p in self.files and p not in self.pages and p not in documents]
            self.pages.update({p: self.name_of(p) for p in documents})
            if documents:
                self.chapters.append((title, documents))
        self.faults += [f"{p}: no chapter has it" for p in self.files if p.startswith("docs/") and p.endswith(".md") and p not in self.pages]
        self.calls = {}
        for p in sorted(self.files):
            if p.startswith("docs/reference/spar"):
                for name in re.findall(r"^### `(spar_\w+)`", self.read(p), re.M):
                    self.calls[name] = f"{self.pages[p]}#{name}"
        theory = self.read("docs/explanation/theory.md")
        self.equations = set(re.findall(r"\\tag\{([^}]*)\}", theory))

    def read(self, path):
        with open(os.path.join(ROOT, path), encoding="utf-8") as file:
            return file.read()

    @staticmethod
    def name_of(path):
        if path == "docs/README.md":
            return "index.html"
        stem = re.sub(r"^docs/|\.md$", "", path)
        return re.sub(r"[/.]", "-", stem).replace("-README", "") + ".html" if "/" in stem else stem.replace("README", "about") + ".html"

    # ---- links

    def source(self, path):
        """The page of a source, or of a folder of sources."""
        if path not in self.sources:
            self.sources[path] = "source-" + re.sub(r"[/.]", "-", path) + ".html"
        return self.sources[path]

    def target(self, path):
        """What shows a path of the repository, or None."""
        path = path.rstrip("/")
        if path in self.pages:
            return self.pages[path]
        if path + "/README.md" in self.pages:
            return self.pages[path + "/README.md"]
        if path in self.files and os.path.splitext(path)[1] in SOURCES:
            return self.source(path)
        if path and path != "." and any(p.startswith(path + "/") for p in self.files):
            return self.source(path)
        return None

    def link(self, document, target):
        if re.match(r"[a-z]+:", target) or target.startswith("#"):
            return target
        path, _, fragment = target.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(document), path))
        found = self.target(path)
        if not found and path in self.files:  # a picture or another file to be shown as it is
            os.makedirs(os.path.join(self.out, os.path.dirname(path)), exist_ok=True)
            shutil.copy(os.path.join(ROOT, path), os.path.join(self.out, path))
            found = path
        if not found:
            self.faults.append(f"{document}: a link to {target}, which is not there")
            return target
        return found + ("#" + fragment if fragment else "")

    def code(self, text):
        """A text in code, with a link where the book has a page of it."""
        plain = html.unescape(text)
        if "src/" + plain in self.files:
            return f'<a href="{self.source("src/" + plain)}"><code>{text}</code></a>'
        if plain in self.calls:
            return f'<a href="{self.calls[plain]}"><code>{text}</code></a>'
        word = re.match(r"((?:examples|src|include|tests|benchmarks|cmake|python|fortran|docs)/[\w./-]*\w)(?= |$)", plain)
        if word and (word.group(1) in self.files or os.path.isdir(os.path.join(ROOT, word.group(1)))):
            found = self.target(word.group(1))
            if found:
                return f'<a href="{found}"><code>{text}</code></a>'
        return f"<code>{text}</code>"

    def listing(self, text):
        return re.sub(r"(<[^>]*>)|\b(spar_[a-z0-9_]+)\b", lambda m: m.group(1) or (
            f'<a href="{self.calls[m.group(2)]}">{m.group(2)}</a>' if m.group(2) in self.calls else m.group(2)), text)

    # ---- a page

    def body(self, document):
        text = self.read(document)
        text = re.sub(r"\$\$\n?(.*?)\$\$", lambda m: "$$" + m.group(1).replace("\n", " ") + "$$", text, flags=re.S)
        made = subprocess.run(["pandoc", "-f", "gfm+tex_math_dollars", "-t", "html5", "--mathml", "--columns=100000"], input=text,
                              capture_output=True, text=True, check=True)
        if made.stderr:
            self.faults.append(f"{document}: {made.stderr.strip()}")
        return made.stdout

    def links(self, document, text):
        text = re.sub(r'(<a [^>]*?href=")([^"]*)(")', lambda m: m.group(1) + html.escape(self.link(document, html.unescape(m.group(2)))) + m.group(3), text)
        text = re.sub(r'(<a href="([^"#]*)[^"]*">)[\w./-]+\.md(</a>)', self.titled, text)
        text = re.sub(r'(<img [^>]*?src=")([^"]*)(")', lambda m: m.group(1) + self.link(document, m.group(2)) + m.group(3), text)
        text = re.sub(r'<p>(<img src="[^"]*" alt="([^"]*)"[^>]*>)</p>', r"<figure>\1<figcaption>\2</figcaption></figure>", text)

        def piece(m):
            if m.group(1):
                return m.group(1)
            return self.listing(m.group(2)) if m.group(2) else self.code(m.group(3))

        text = re.sub(r"(<a [^>]*>.*?</a>|<h\d.*?</h\d>)|(<pre.*?</pre>)|<code>([^<]*)</code>", piece, text, flags=re.S)
        text = re.sub(r"<p>(<math display=\"block\".*?</math>)</p>", self.equation, text, flags=re.S)
        theory = self.pages["docs/explanation/theory.md"]
        parts = re.split(r"(<pre.*?</pre>|<math.*?</math>|<code.*?</code>|<a .*?</a>|<[^>]*>)", text, flags=re.S)
        for i in range(0, len(parts), 2):
            parts[i] = re.sub(r"\(([TESWFJ]\d+)\)", lambda m: f'(<a href="{theory}#{m.group(1)}">{m.group(1)}</a>)' if m.group(1) in self.equations
                              else m.group(0), parts[i])
            parts[i] = raised(parts[i])
            if document == "docs/explanation/theory.md":
                parts[i] = symbols(parts[i])
        text = "".join(parts)
        return re.sub(r"(<table>.*?</table>)", r'<div class="table">\1</div>', text, flags=re.S)

    def titled(self, m):
        """A link whose text is the name of a document has the document's title."""
        title = next((self.titles[p] for p, page in self.pages.items() if page == m.group(2)), None)
        return m.group(1) + title + m.group(3) if title else m.group(0)

    @staticmethod
    def equation(m):
        tag = re.search(r"\\tag\{([^}]*)\}", m.group(1))
        if not tag:
            return f'<div class="equation">{m.group(1)}</div>'
        return f'<div class="equation" id="{tag.group(1)}">{m.group(1)}<span class="tag">({tag.group(1)})</span></div>'

    def write(self, name, title, body, document=None):
        order = [p for _, documents in self.chapters for p in documents]
        contents = []
        for chapter, documents in self.chapters:
            here = document in documents
            contents.append(f'<details{" open" if here else ""}><summary>{chapter}</summary><ul>')
            for p in documents:
                entry = f'<a href="{self.pages[p]}">{html.escape(self.titles[p])}</a>'
                inner = ""
                if p == document:
                    entry = f"<b>{entry}</b>"
                    heads = re.findall(r'<h2 id="([^"]*)">(.*?)</h2>', body, re.S)
                    inner = "<ul>" + "".join(f'<li><a href="#{i}">{re.sub("</?a[^>]*>", "", h)}</a></li>' for i, h in heads) + "</ul>" if heads else ""
                contents.append(f"<li>{entry}{inner}</li>")
            contents.append("</ul></details>")
        foot = ""
        if document in order:
            at = order.index(document)
            before, after = order[at - 1] if at else None, order[at + 1] if at + 1 < len(order) else None
            foot = "<footer>" + "".join(f'<a href="{self.pages[p]}">{sign[0]}{html.escape(self.titles[p])}{sign[1]}</a>'
                                        for p, sign in ((before, ("← ", "")), (after, ("", " →"))) if p) + "</footer>"
        page = TEMPLATE.format(title=html.escape(title), contents="".join(contents), body=body, foot=foot, version=self.version)
        with open(os.path.join(self.out, name), "w", encoding="utf-8") as file:
            file.write(page)

    def remember(self, name, title, body):
        """The sections of a page, for the search."""
        plain = lambda text: re.sub(r"\s+", " ", html.unescape(
            re.sub(r"<[^>]*>", " ", re.sub(r"<annotation.*?</annotation>|</?(?:span|a|code|sup|b|strong|em)\b[^>]*>", "", text, flags=re.S)))).strip()
        parts = re.split(r'<h[1-4] id="([^"]*)">(.*?)</h[1-4]>', body, flags=re.S)
        for i in range(1, len(parts), 3):
            self.index.append([f"{name}#{parts[i]}", title, plain(parts[i + 1]), plain(parts[i + 2])])

    def source_page(self, path):
        full = os.path.join(ROOT, path)
        if os.path.isdir(full):
            inside = sorted({p[len(path) + 1 :].split("/")[0] for p in self.files if p.startswith(path + "/")})
            entries = [f'<li><a href="{found}">{html.escape(p)}</a></li>' for p in inside for found in [self.target(f"{path}/{p}")] if found]
            return f"<h1>{path}</h1><ul>{''.join(entries)}</ul>"
        text = html.escape(self.read(path), quote=False)
        mark = {".c": r"/\*.*?\*/", ".h": r"/\*.*?\*/", ".f90": r"![^\n]*"}.get(os.path.splitext(path)[1], r"(?m)^\s*#[^\n]*")
        text = re.sub(mark, lambda m: f'<span class="co">{m.group(0)}</span>', text, flags=re.S if "*" in mark[:4] else 0)
        return f"<h1>{path}</h1><pre class=\"source\">{self.listing(text)}</pre>"

    def make(self):
        shutil.rmtree(self.out, ignore_errors=True)
        os.makedirs(self.out)
        self.version = re.search(r"project\(spar VERSION ([\d.]+)", self.read("CMakeLists.txt")).group(1)
        order = [p for _, documents in self.chapters for p in documents]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            bodies = dict(zip(order, pool.map(self.body, order)))
        for p in order:
            head = re.search(r"<h1[^>]*>(.*?)</h1>", bodies[p], re.S)
            self.titles[p] = re.sub(r"<[^>]*>", "", head.group(1)) if head else p
            if not head:
                self.faults.append(f"{p}: has no title")
        for p in order:
            body = self.links(p, bodies[p])
            self.write(self.pages[p], html.unescape(self.titles[p]), body, p)
            self.remember(self.pages[p], html.unescape(self.titles[p]), body)
        done = set()
        while set(self.sources) - done:
            for path in sorted(set(self.sources) - done):
                self.write(self.sources[path], path, self.source_page(path))
                done.add(path)
        with open(os.path.join(self.out, "search.js"), "w", encoding="utf-8") as file:
            file.write("const sections = " + json.dumps(self.index, ensure_ascii=False) + ";\n" + SEARCH)
        with open(os.path.join(self.out, "style.css"), "w", encoding="utf-8") as file:
            file.write(STYLE)
        self.check()
        return len(order), len(done)

    # ---- what is wrong

    def check(self):
        read = {name: Reader.of(os.path.join(self.out, name)) for name in os.listdir(self.out) if name.endswith(".html")}
        for name, page in read.items():
            for target in page.targets:
                if re.match(r"[a-z]+:", target):
                    continue
                file, _, fragment = target.partition("#")
                file = file or name
                if not os.path.exists(os.path.join(self.out, file)):
                    self.faults.append(f"{name}: a link to {file}, which is not there")
                elif fragment and file in read and fragment not in read[file].names:
                    self.faults.append(f"{name}: a link to {target}, which has no such part")
            if not name.startswith("source-"):
                for raw in re.findall(r"\]\([^)\s]*\)|\$\$|\*\*|```|\\(?:frac|tag|dot|begin)\b|^\|.*\|$|<!--", page.text, re.M):
                    self.faults.append(f"{name}: markup is left as it stands: {raw[:60]}")


class Reader(html.parser.HTMLParser):
    """Links, names and the text outside code of a page."""

    def __init__(self):
        super().__init__()
        self.targets, self.names, self.parts, self.inside = [], set(), [], 0

    @classmethod
    def of(cls, path):
        page = cls()
        with open(path, encoding="utf-8") as file:
            page.feed(file.read())
        page.text = "".join(page.parts)
        return page

    def handle_starttag(self, tag, attributes):
        a = dict(attributes)
        self.inside += tag in ("code", "pre", "annotation", "script")
        self.targets += [a[key] for key in ("href", "src") if a.get(key)]
        self.names |= {a["id"]} if a.get("id") else set()

    def handle_endtag(self, tag):
        self.inside -= tag in ("code", "pre", "annotation", "script")

    def handle_data(self, data):
        if not self.inside:
            self.parts.append(data)


TEMPLATE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - spar</title><link rel="stylesheet" href="style.css"></head><body>
<nav><a class="name" href="index.html">spar {version}</a>
<input id="search" type="search" placeholder="Search" autocomplete="off" aria-label="Search"><div id="found"></div>{contents}</nav>
<main>{body}{foot}</main><script src="search.js"></script></body></html>
"""

STYLE = """:root { --ink: #1d2430; --soft: #5b6675; --line: #dde2e8; --back: #f6f8fa; --link: #0b5cad; }
* { box-sizing: border-box; }
body { margin: 0; display: flex; color: var(--ink); font: 16px/1.55 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
nav { width: 19rem; flex: none; height: 100vh; position: sticky; top: 0; overflow-y: auto; padding: 1rem; background: var(--back);
  border-right: 1px solid var(--line); font-size: 14px; line-height: 1.4; }
nav .name { display: block; font-size: 20px; font-weight: 700; color: var(--ink); margin-bottom: .6rem; }
nav input { width: 100%; padding: .4rem .6rem; border: 1px solid var(--line); border-radius: 6px; font: inherit; margin-bottom: .6rem; }
nav ul { list-style: none; margin: .2rem 0 .6rem; padding-left: .9rem; } nav li { margin: .25rem 0; } nav ul ul { margin: .2rem 0; }
nav { overflow-wrap: anywhere; } nav summary { cursor: pointer; font-weight: 600; padding: .15rem 0; } nav code { font-size: 12px; background: none; padding: 0; }
#found a { display: block; padding: .35rem 0; border-bottom: 1px solid var(--line); } #found small { display: block; color: var(--soft); }
main { flex: 1; min-width: 0; max-width: 62rem; padding: 1.5rem 2.5rem 4rem; }
a { color: var(--link); text-decoration: none; } a:hover { text-decoration: underline; }
h1 { font-size: 30px; line-height: 1.2; margin: .2rem 0 1rem; } h2 { font-size: 23px; margin: 2.2rem 0 .7rem; padding-top: .5rem; border-top: 1px solid var(--line); }
h3 { font-size: 18px; margin: 1.7rem 0 .5rem; } h3 code { background: none; padding: 0; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", Consolas, monospace; font-size: .86em; }
code { background: var(--back); padding: .1em .3em; border-radius: 4px; } a code { color: var(--link); }
pre { background: var(--back); border: 1px solid var(--line); border-radius: 6px; padding: .7rem .9rem; overflow-x: auto; line-height: 1.45; }
pre code { background: none; padding: 0; font-size: 1em; } pre.source { font-size: 13px; }
.table { overflow-x: auto; margin: 1rem 0; } table { border-collapse: collapse; font-size: 14.5px; }
th, td { border-bottom: 1px solid var(--line); padding: .35rem .7rem; text-align: left; vertical-align: top; } th { background: var(--back); }
figure { margin: 1.5rem 0; } img { max-width: 100%; } figcaption { color: var(--soft); font-size: 14px; }
.equation { display: flex; align-items: center; margin: 1rem 0; overflow-x: auto; } .equation math { flex: 1; font-size: 1.2em; } sup, sub { line-height: 0; font-size: .75em; }
.equation .tag { color: var(--soft); padding-left: 1rem; } .equation:target { background: #fff6d6; }
footer { display: flex; justify-content: space-between; gap: 2rem; margin-top: 3rem; padding-top: 1rem; border-top: 1px solid var(--line); }
.co, .sourceCode .co { color: #5d7a4d; } .sourceCode .kw, .sourceCode .cf { color: #8a3ea8; } .sourceCode .dt { color: #0f6a8b; }
.sourceCode .st, .sourceCode .ch { color: #a4551e; } .sourceCode .dv, .sourceCode .fl { color: #2f6f3a; } .sourceCode .pp { color: #7b6a1c; }
@media (max-width: 800px) { body { display: block; } nav { position: static; width: auto; height: auto; } main { padding: 1rem; } }
"""

SEARCH = """const box = document.getElementById('search'), found = document.getElementById('found');
function look() {
  const words = box.value.toLowerCase().split(/\\s+/).filter(w => w.length > 1);
  found.textContent = '';
  if (!words.length) return;
  const hits = [];
  for (const [url, title, head, text] of sections) {
    const t = title.toLowerCase(), h = head.toLowerCase(), x = text.toLowerCase();
    let score = 0;
    for (const w of words) {
      const here = (h === w ? 40 : h.includes(w) ? 12 : 0) + (t.includes(w) ? 4 : 0) + Math.min(3, x.split(w).length - 1);
      if (!here) { score = 0; break; }
      score += here;
    }
    if (score) hits.push([score, url, title, head, text]);
  }
  hits.sort((a, b) => b[0] - a[0]);
  for (const [, url, title, head, text] of hits.slice(0, 30)) {
    const a = document.createElement('a'), small = document.createElement('small');
    const at = Math.max(0, text.toLowerCase().indexOf(words[0]) - 30);
    a.href = url;
    a.textContent = head;
    small.textContent = (head === title ? '' : title + ': ') + text.slice(at, at + 110);
    a.append(small);
    found.append(a);
  }
  if (!hits.length) found.textContent = 'nothing found';
}
box.addEventListener('input', look);
const asked = new URLSearchParams(location.search).get('search');
if (asked) { box.value = asked; look(); }
"""


def main():
    book = Book(sys.argv[1])
    pages, sources = book.make()
    if book.faults:
        print("\n".join(sorted(set(book.faults))))
        sys.exit(f"{len(set(book.faults))} faults")
    print(f"{pages} pages and {sources} sources: {os.path.join(book.out, 'index.html')}")


if __name__ == "__main__":
    main()
