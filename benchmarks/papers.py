"""Claims of the papers with figures and sensitivity: writes the lists and tables of docs/papers.md.

    python benchmarks/papers.py                     all experiments
    python benchmarks/papers.py faraji mistry       some of them
    python benchmarks/papers.py --no-sensitivity    without the variants
    python benchmarks/papers.py --figures           only the figures in docs/papers

The text between the comments `<!-- begin NAME -->` and `<!-- end NAME -->` is replaced. One
experiment with its variants takes minutes.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from pathlib import Path

from PIL import Image
from tables import table

from mgs.core.atomic_files import replace_file
from mgs.experiments import NAMES, Claim, run
from mgs.experiments.sensitivity import Sensitivity, measure

PAGE = Path(__file__).resolve().parent.parent / "docs" / "papers.md"
FIGURES = PAGE.parent / "papers"
COLOURS = 48  # of a figure in the documentation, which keeps it below 150 kB
VERDICTS = {True: "**Holds.**", False: "**FAILS.**", "not applicable": "**Not tested.**"}
MARKS = {True: "holds", False: "FAILS", "not applicable": "-"}


def claim_list(claims: list[Claim]) -> str:
    """Numbered list of claims: source, sentence, verdict, figure, robustness, measure."""
    items = []
    for i, claim in enumerate(claims, start=1):
        source = "ours" if claim.kind == "ours" else claim.source
        methods = f" ({', '.join(claim.methods)})" if claim.methods else ""
        text = f"{i}. `{claim.id}` [{source}] {claim.claim}{methods}. {VERDICTS[claim.holds]}"
        if claim.holds != "not applicable":
            text += f" {claim.figure}."
            if claim.robustness:
                text += f" *{claim.robustness[0].upper() + claim.robustness[1:]}.*"
        note = claim.note[:1].upper() + claim.note[1:]
        items.append(text + (f"\n   {note}." if note else ""))
    return "\n".join(items)


def variant_table(found: Sensitivity) -> str:
    """Table of the claims that change in at least one variant, one column for each variant."""
    changed = [c for c in found.claims if (c.robustness or "").startswith("fragile")]
    head = ["claim", "as shipped", *found.variants]
    rows = [
        [f"`{c.id}`", MARKS[c.holds], *(MARKS[v[c.id].holds] for v in found.variants.values())]
        for c in changed
    ]
    lines = [f"Variants: {', '.join(found.variants)}." if found.variants else "No variants."]
    lines += [f"Not run: {name}: {reason}." for name, reason in found.refused.items()]
    if rows:
        lines.append("Claims that change in a variant:\n\n" + table(head, rows))
    return "\n\n".join(lines)


def section(name: str, sensitivity: bool) -> str:
    """Text of one experiment."""
    if not sensitivity:
        return claim_list(run(name))
    found = measure(name, lambda done, total: print(f"\r{name} {done}/{total}", end="", flush=True))
    print()
    return f"{claim_list(found.claims)}\n\n{variant_table(found)}"


def replaced(page: str, name: str, text: str) -> str:
    """Page with the text between the markers of one experiment replaced."""
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    if not pattern.search(page):
        raise SystemExit(f"{PAGE}: {begin} and {end} are missing")
    return pattern.sub(lambda _: f"{begin}\n{text}\n{end}", page)


def write_figures(name: str) -> None:
    """Draw the figures of one experiment, with few colours, in docs/papers/NAME."""
    place = FIGURES / name
    place.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        run(name, Path(folder))
        for path in sorted(Path(folder).glob("*.png")):
            with Image.open(path) as image:
                small = image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
                small.save(place / path.name, optimize=True)


def main() -> None:
    """Run the experiments and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--no-sensitivity", action="store_true", help="leave the variants out")
    parser.add_argument("--figures", action="store_true", help="draw figures, write no text")
    args = parser.parse_args()
    unknown = set(args.names) - set(NAMES)
    if unknown:
        sys.exit(f"{', '.join(sorted(unknown))}: unknown; the experiments are {', '.join(NAMES)}")
    for name in args.names or NAMES:
        if args.figures:
            write_figures(name)
            continue
        text = section(name, not args.no_sensitivity)
        page = replaced(PAGE.read_text(encoding="utf-8"), name, text)
        replace_file(PAGE, page.encode())


if __name__ == "__main__":
    main()
