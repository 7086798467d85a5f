# SPDX-License-Identifier: Apache-2.0
"""The changes that mutation testing makes to a C file, found in its syntax tree.

Only function bodies are changed. What must be constant (case labels, array sizes, enumerations,
static objects) stays, because all mutants of a file are compiled at once and chosen at run time.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import tree_sitter_c
from tree_sitter import Language, Node, Parser

_PARSER = Parser(Language(tree_sitter_c.language()))
_OTHER_OPERATORS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "&&": ("||",),
    "||": ("&&",),
    "+": ("-",),
    "-": ("+",),
    "*": ("/",),
    "/": ("*",),
    "%": ("*",),
    "<<": (">>",),
    ">>": ("<<",),
    "&": ("|",),
    "|": ("&",),
    "^": ("|",),
    "+=": ("-=",),
    "-=": ("+=",),
    "*=": ("/=",),
    "/=": ("*=",),
    "<<=": (">>=",),
    ">>=": ("<<=",),
    "&=": ("|=",),
    "|=": ("&=",),
    "^=": ("|=",),
    "++": ("--",),
    "--": ("++",),
}
_LOGICAL = ("&&", "||")
_RELATIONAL = ("<", "<=", ">", ">=", "==", "!=")
# Calls whose value is one of their arguments unless a limit acts: the limit is left out.
_CLAMPS = {
    "q_min": (0, 1),
    "q_max": (0, 1),
    "q_clamp": (0,),
    "q_abs": (0,),
    "q15_saturate": (0,),
    "q_saturate64": (0,),
}
_CONSTANT = re.compile(r"[A-Z][A-Z0-9_]+")
_PURE = re.compile(r"q\d*_")  # core's arithmetic: no effect, no pointer
_NOT_CHANGED = {
    "case_statement": ("value",),
    "array_declarator": ("size",),
    "init_declarator": ("declarator",),
    "call_expression": ("function",),
}
_SKIPPED = ("enum_specifier", "sizeof_expression", "subscript_designator", "type_descriptor")


@dataclass(frozen=True)
class Change:
    """One change: the node's bytes and what stands there instead.

    `removed` marks a statement that is left out; then `replacement` is empty. `comparable` marks an
    expression that may be evaluated both ways: neither has an effect, a divisor of zero or
    an index that it guards.
    """

    kind: str
    start: int
    end: int
    line: int
    original: str
    replacement: str
    removed: bool = False
    comparable: bool = False


@dataclass(frozen=True)
class Source:
    """A parsed file."""

    text: bytes
    root: Node
    objects: frozenset[str]  # const objects and macros with arguments: not constants

    def of(self, node: Node) -> str:
        """Return the text of a node."""
        return self.text[node.start_byte : node.end_byte].decode()


def parse(text: bytes) -> Source:
    """Return the syntax tree of a C file."""
    root = _PARSER.parse(text).root_node
    names = re.findall(rb"\bconst\s+\w+\s*\*?\s*(?:const\s+)?([A-Z][A-Z0-9_]+)\b", text)
    names += re.findall(rb"#\s*define\s+(\w+)\(|\b([A-Z][A-Z0-9_]+)\(", text)
    flat = (name if isinstance(name, bytes) else name[0] or name[1] for name in names)
    return Source(text, root, frozenset(name.decode() for name in flat))


def one_line(text: str) -> str:
    """Return a text with every run of white space as one blank, and without comments."""
    return " ".join(re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL).split())


def changes(source: Source) -> list[Change]:
    """Return every change of a file, in the order of its text."""
    found: list[Change] = []
    for function in _functions(source.root):
        body = function.child_by_field_name("body")
        if body is None:
            continue
        is_void = _is_void(source, function)
        for node in _changeable(source, body):
            for kind, replacement, removed in _of_node(source, node, is_void):
                found.append(
                    Change(
                        kind,
                        node.start_byte,
                        node.end_byte,
                        node.start_point.row + 1,
                        one_line(source.of(node)),
                        one_line(replacement),
                        removed,
                        _is_comparable(source, node, kind, replacement),
                    )
                )
    return found


def _is_comparable(source: Source, node: Node, kind: str, replacement: str) -> bool:
    """Return whether the program stays the same when both values are computed."""
    guarded = {"logical": "/%[", "arithmetic": "/%"}.get(kind, "")
    unguarded = not set(guarded) & set(replacement)
    if kind == "logical" and "NULL" in source.of(node):
        return False
    return kind != "statement" and unguarded and not _has_effects(source, node)


def _has_effects(source: Source, node: Node) -> bool:
    if node.type in ("assignment_expression", "update_expression"):
        return True
    if node.type == "call_expression":
        function = node.child_by_field_name("function")
        if function is None or not _PURE.match(source.of(function)):
            return True
    return any(_has_effects(source, child) for child in node.named_children)


def _functions(node: Node) -> Iterator[Node]:
    for child in node.named_children:
        if child.type == "function_definition":
            yield child
        elif child.type.startswith("preproc_"):
            yield from _functions(child)


def _is_void(source: Source, function: Node) -> bool:
    result = function.child_by_field_name("type")
    return result is not None and source.of(result) == "void"


def _changeable(source: Source, node: Node) -> Iterator[Node]:
    """Yield a node and all below it that are evaluated at run time; raise ValueError at bad C."""
    if node.type in _SKIPPED or node.type.startswith("preproc_"):
        return
    if node.type == "declaration" and any(
        child.type == "storage_class_specifier" and source.of(child) == "static"
        for child in node.children
    ):
        return
    if node.is_error or node.is_missing:
        raise ValueError(f"line {node.start_point.row + 1} is not understood")
    yield node
    if node.type == "call_expression" and _is_macro(source, node):
        return
    kept = _NOT_CHANGED.get(node.type, ())
    for index, child in enumerate(node.children):
        name = node.field_name_for_child(index)
        if not child.is_named:
            continue
        if name in kept and child.type != "array_declarator":
            if node.type == "init_declarator":
                yield from _changeable(source, child)
            continue
        if node.type == "array_declarator" and name != "declarator":
            continue
        yield from _changeable(source, child)


def _is_macro(source: Source, call: Node) -> bool:
    """Return whether a call may paste its arguments into names."""
    function = call.child_by_field_name("function")
    return function is not None and _CONSTANT.fullmatch(source.of(function)) is not None


def _of_node(source: Source, node: Node, is_void: bool) -> Iterator[tuple[str, str, bool]]:
    """Yield the changes of one node: kind, replacement, whether it is a statement left out."""
    if node.type in ("binary_expression", "assignment_expression"):
        yield from _of_binary(source, node)
    elif node.type == "update_expression":
        operator = node.child_by_field_name("operator")
        assert operator is not None
        text = source.of(operator)
        yield "arithmetic", source.of(node).replace(text, _OTHER_OPERATORS[text][0]), False
    elif node.type == "unary_expression":
        operator, argument = (node.child_by_field_name(n) for n in ("operator", "argument"))
        assert operator is not None and argument is not None
        if not (source.of(operator) == "-" and argument.type == "number_literal"):
            kind = "condition" if source.of(operator) == "!" else "arithmetic"
            yield kind, source.of(argument), False
    elif node.type == "call_expression":
        yield from _of_call(source, node)
    elif node.type in ("number_literal", "identifier"):
        yield from _of_constant(source, node)
    elif node.type in ("true", "false"):
        yield "constant", "false" if node.type == "true" else "true", False
    elif _can_be_left_out(source, node, is_void):
        yield "statement", "", True
    if _is_condition(node) and node.type not in ("true", "false", "number_literal"):
        operator = node.child_by_field_name("operator")
        plain = operator is None or (source.of(operator) not in (*_RELATIONAL, *_LOGICAL, "!"))
        if plain:
            yield "condition", f"!({source.of(node)})", False


def _can_be_left_out(source: Source, node: Node, is_void: bool) -> bool:
    if node.type == "expression_statement":
        return bool(node.named_children) and not source.of(node).startswith("(void)")
    jump = node.type in ("break_statement", "continue_statement")
    return jump or (node.type == "return_statement" and is_void)


def _of_binary(source: Source, node: Node) -> Iterator[tuple[str, str, bool]]:
    left, operator, right = (node.child_by_field_name(n) for n in ("left", "operator", "right"))
    assert left is not None and operator is not None and right is not None
    text = source.of(operator)
    if text in _RELATIONAL:
        kind = "relational"
    elif text in _LOGICAL:
        kind = "logical"
    else:
        kind = "arithmetic"
    for other in _OTHER_OPERATORS.get(text, ()):
        yield kind, f"({source.of(left)}) {other} ({source.of(right)})", False
    if text in _LOGICAL:
        yield kind, source.of(left), False
        yield kind, source.of(right), False


def _of_call(source: Source, node: Node) -> Iterator[tuple[str, str, bool]]:
    function, arguments = (node.child_by_field_name(n) for n in ("function", "arguments"))
    assert function is not None and arguments is not None
    given = [child for child in arguments.named_children if child.type != "comment"]
    for index in _CLAMPS.get(source.of(function), ()):
        yield "clamp", source.of(given[index]), False


def _of_constant(source: Source, node: Node) -> Iterator[tuple[str, str, bool]]:
    text = source.of(node)
    if node.type == "identifier":
        if not _CONSTANT.fullmatch(text) or text == "NULL" or text in source.objects:
            return
        value = None
    else:
        value = int(text.rstrip("uUlL"), 0) if not re.search(r"[.eEpP]", text) else None
    yield "constant", f"{text} + 1", False
    if value == 1:
        yield "constant", "0", False
    else:
        yield "constant", f"{text} - 1", False
        if value != 0:
            yield "constant", "0", False


def _is_condition(node: Node) -> bool:
    child, parent = node, node.parent
    while parent is not None and parent.type == "parenthesized_expression":
        child = parent
        parent = child.parent
    if node.type == "parenthesized_expression" or parent is None:
        return False
    kinds = ("if_statement", "while_statement", "do_statement", "for_statement")
    if parent.type not in (*kinds, "conditional_expression"):
        return False
    condition = parent.child_by_field_name("condition")
    return condition is not None and condition.id == child.id
