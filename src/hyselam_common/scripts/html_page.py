"""One way to make HTML pages: a jinja2 template that extends base.html, and values for it."""
import pathlib

import jinja2

HERE = pathlib.Path(__file__).resolve().parent
BASE = HERE.parent / "pages"  # beside this folder in the sources and in share/hyselam_common


def write_page(target, template, **values):
    """Renders the template file with the values, escaped, and puts the page in place at once."""
    template, target = pathlib.Path(template), pathlib.Path(target)
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader([template.parent, BASE]), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    draft = target.with_name(target.name + ".part")
    draft.write_text(environment.get_template(template.name).render(values) + "\n")
    draft.replace(target)
