"""A catalogue that is computed in seconds."""

from pathlib import Path

PAPER = """
title = "A small paper, computed anew"
about = "Two statements on a filament, and one on a chain."
"""
ONSET = """
order = 10
title = "When it begins"
paper = "Section 1"
about = "The onset of a filament."

[tasks.onset]
call = "stability --plot {out}/onset.svg --overwrite"

[tasks.slow]
call = "stability --set load.profile=linear --set load.slope=0"
only_full = true

[[claims]]
name = "hopf"
says = "It begins to oscillate at 37.7."
where = "Section 1"
value = "onset.hopf_force"
error = "onset.error"
published = 37.7
within = 0.05
because = "three digits are printed"
unit = "B/L²"
figure = "onset"

[[claims]]
name = "spread"
says = "Spread evenly, the force has to be larger."
where = "Section 1"
value = "slow.hopf_force > onset.hopf_force"
published = true

[[figures]]
name = "onset"
shows = "Figure 1"
caption = "Growth rate and frequency."
file = "{onset}/onset.svg"
"""
STUDY = """
order = 20
title = "Some motions"
paper = "Section 2"
about = "Runs of few links."

[tasks.runs]
call = "sweep {inputs}/small.toml --out {out}/study.zarr"
all_cores = true

[tasks.diagram]
call = "plot {runs}/study.zarr --out {out}/diagram.png --overwrite"

[tasks.page]
call = "plot {runs}/study.zarr --out {out}/page.html --overwrite"

[tasks.run]
call = '''
run --set model.segments=4 --set time.until=0.02 --set time.samples=40 --out {out} --overwrite
'''

[uses]
onset = "onset/onset"

[[claims]]
name = "many"
says = "Eight points are looked at."
where = "Section 2"
value = "found(runs, 'straight') + found(runs, 'undecided') + found(runs, 'spinning')"
published = 4.0

[[claims]]
name = "all-forces"
says = "All of this holds from 10 to 40."
where = "Section 2"
value = "[10.0, onset.hopf_force]"
over = [10.0, 40.0]
unit = "B/L²"
expected = "confirmed within a stated range"

[[figures]]
name = "diagram"
shows = "Figure 2"
caption = "Verdicts."
file = "{diagram}/diagram.png"
page = "{page}/page.html"

[[figures]]
name = "run"
shows = "Figure 3"
caption = "A run."
file = "{run}/run.png"

[[movies]]
shows = "Movie 1"
caption = "The same run."
file = "{run}/run.mp4"
"""
INPUT = """
[model]
segments = 4
[time]
until = 0.02
samples = 40
[study]
keep = "period"
[[study.axes]]
key = "load.position"
values = [0.5, 1.0]
[[study.axes]]
key = "load.force"
values = [10, 60]
[load]
profile = "point"
"""


def small_catalogue(folder: Path, **changed: tuple[str, str]) -> Path:
    """Write the catalogue, with one text of an item replaced for each name given; return it."""
    texts = {"paper": PAPER, "onset": ONSET, "study": STUDY}
    for name, (old, new) in changed.items():
        assert texts[name].count(old) == 1
        texts[name] = texts[name].replace(old, new)
    (folder / "inputs").mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    (folder / "inputs" / "small.toml").write_text(INPUT, encoding="utf-8")
    return folder
