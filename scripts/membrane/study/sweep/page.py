# SPDX-License-Identifier: GPL-2.0-or-later
"""The page of a sweep's report: one HTML file that shows pictures and tables."""

import os
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, StrictUndefined

TEMPLATE = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy"
      content="default-src 'none'; style-src 'unsafe-inline'; img-src 'self' file:">
<title>Sweep{{ " over " if axes }}{{ axes | join(" and ") }}</title>
<style>
body { font: 15px/1.45 sans-serif; color: #222; max-width: 68rem;
       margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
figure { margin: 1rem 0; } figure img { max-width: 100%; }
figcaption { color: #555; font-size: 0.9rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; min-width: 34rem; }
th, td { padding: 0.25rem 0.6rem; border-bottom: 1px solid #ddd;
         text-align: left; vertical-align: top; }
th { vertical-align: bottom; }
th { background: #f4f4f2; font-weight: 600; } th small { font-weight: 400; color: #666; }
td:first-child { white-space: nowrap; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
tr.diverged td { background: #fdf0e3; }
tr.damaged td, tr.failed td, tr.killed td, tr.running td, tr.missing td {
     background: #fbe6e6; }
.shapes { display: grid; gap: 1rem;
          grid-template-columns: repeat(auto-fill, minmax(min(24rem, 100%), 1fr)); }
</style>
</head>
<body>
<h1>Sweep{{ " over " if axes }}{{ axes | join(" and ") }}</h1>
<p>{{ cases | length }} cases:
{%- for state, count in states.items() %} {{ count }} {{ state }}{{ "." if loop.last else "," }}
{%- endfor %} All numbers are in <a href="{{ table | place }}">{{ table }}</a>.</p>

{% for name, caption in pictures.items() %}
<figure><a href="{{ name | place }}"><img src="{{ name | place }}" alt="{{ caption }}"></a>
<figcaption>{{ caption }}</figcaption></figure>
{% endfor %}

{% if others %}
<h2>Cases that are not complete</h2>
<p>A diverged case is a result: run again it diverges again. Times in the reasons are on YADE's
clock, which runs through the spin-up; those in the table count from the release. All other cases
are missing; the sweep's command runs them, and them alone.
{% if "damaged" in states %}Damaged ones it runs once their folders are removed.{% endif %}</p>
<div class="wide"><table>
<tr><th>case</th><th>outcome</th><th class="number">at <small>[s]</small></th><th>because</th></tr>
{% for status in others %}
<tr class="{{ status.state | replace("not begun", "missing") }}">
<td>{{ status.name }}</td><td>{{ status.state }}</td>
<td class="number">{% if status.state == "diverged" %}
{{- "in the spin-up" if status.time is none else "%.4g" % status.time }}{% endif %}</td>
<td>{{ status.reason }}</td></tr>
{% endfor %}
</table></div>
{% endif %}

<h2>All cases</h2>
<div class="wide"><table>
<tr><th>case</th><th>outcome</th>
{%- for name, unit, meaning in columns %}
<th class="number" title="{{ meaning }}">{{ name | replace("_", " ") }}
{%- if unit != "-" %} <small>[{{ unit }}]</small>{% endif %}</th>{% endfor %}</tr>
{% for case in cases %}
<tr class="{{ case.state | replace("not begun", "missing") }}">
<td>{% if case.place %}<a href="{{ (case.page or case.place ~ "/") | place }}">{{ case.name }}</a>
{%- else %}{{ case.name }}{% endif %}</td>
<td>{{ case.state }}</td>
{%- for value in case["values"] %}<td class="number">{{ value or "–" }}</td>{% endfor %}</tr>
{% endfor %}
</table></div>
<ul>
{% for name, unit, meaning in columns if meaning %}
<li><b>{{ name | replace("_", " ") }}</b>: {{ meaning }}</li>
{% endfor %}
</ul>

{% if cases | selectattr("shapes") | list %}
<h2>Shapes</h2>
<div class="shapes">
{% for case in cases if case.shapes %}
<figure><a href="{{ case.shapes | place }}">
<img src="{{ case.shapes | place }}" loading="lazy" alt="Shapes of {{ case.name }}"></a>
<figcaption>{{ case.name }}
{%- if case.page %}: <a href="{{ case.page | place }}">in 3D</a>{% endif %}</figcaption></figure>
{% endfor %}
</div>
{% endif %}

<h2>Parameters that all cases share</h2>
<div class="wide"><table>
<tr><th>parameter</th><th class="number">value</th><th>unit</th><th>meaning</th><th>from</th></tr>
{% for name, value, unit, meaning, source in common %}
<tr><td>{{ name }}</td><td class="number">{{ value }}</td><td>{{ unit }}</td>
<td>{{ meaning }}</td><td>{{ source }}</td></tr>
{% endfor %}
</table></div>

<p>Made with
{% for name, value in versions.items() %}
{{ name }} {{ value }}{{ "." if loop.last else "," }}
{% endfor %}
</p>
</body>
</html>
"""


def place(path: str) -> str:
    """A path relative to the page as a link has it: no name can be taken for more than a name."""
    return quote(os.fsencode(path))


def render(**content: Any) -> str:
    """The page's HTML; all texts are escaped."""
    environment = Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined
    )
    environment.filters["place"] = place
    return environment.from_string(TEMPLATE).render(**content)
