"""The command `cubeling character graph`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.tree import Tree

from cubeling.app.commands.output import OverwriteOption
from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output
from cubeling.files import write_whole

if TYPE_CHECKING:
    from cubeling.characters.motion import Node, Plan, StateTransition


def graph(
    character: Annotated[
        str, typer.Argument(help="A bundled character, or a .glb, .gltf or .vrm file.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The .dot file (Graphviz) to write the graph to."),
    ] = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Show how a character's motions are composed: blend trees, layers, states.

    A .toml file next to the character describes them; see docs/motion-files.md. Without such a
    file, the built-in motions for the character's clips are shown.

    Graphviz draws the .dot file: dot -Tsvg human.dot -o human.svg

    Example: cubeling character graph human -o human.dot
    """
    if output is not None:
        check_output(output, "graph", (".dot",), overwrite=overwrite)
    from cubeling.characters import Animator, Character, built_in_trees
    from cubeling.characters.motion import to_dot

    loaded = Character.load(character)
    plan = loaded.plan or built_in_trees(loaded)
    if loaded.plan is not None:
        Animator(loaded)  # refuses plans that cannot be played
    Console().print(outline(plan, loaded.name))
    if output is None:
        return
    write_whole(output, to_dot(plan, loaded.name), AppError)
    Console().print(f"[bold]{escape(str(output))}[/] is written; Graphviz draws it.")


def outline(plan: Plan, name: str) -> Tree:
    """Return a plan as an indented list for the console."""
    tree = Tree(f"[bold]{escape(name)}[/]  [dim]from {escape(plan.source)}[/]")
    if plan.machine is None:
        for root in plan.roots:
            _grow(tree, root, "")
        return tree
    for state, node in plan.machine.states.items():
        first = "first state" if state == plan.machine.start else "state"
        branch = tree.add(f"[bold yellow]{escape(state)}[/]  [dim]{first}[/]")
        _grow(branch, node, "")
        for transition in plan.machine.transitions:
            if transition.start == state:
                branch.add(f"[yellow]→ {_describe(transition)}", highlight=True)
    for transition in plan.machine.transitions:
        if transition.start == "*":
            tree.add(f"[yellow]any → {_describe(transition)}", highlight=True)
    return tree


def _describe(transition: StateTransition) -> str:
    return f"{escape(transition.end)}[/] when {escape(transition.when.text)}"


def _grow(tree: Tree, node: Node, label: str) -> None:
    at = f"[cyan]{escape(label)}[/] " if label else ""
    branch = tree.add(f"{at}{escape(node.name or node.kind)}  [dim]{escape(node.description)}[/]")
    for inner, child in zip(node.labels, node.children, strict=True):
        _grow(branch, child, inner)
