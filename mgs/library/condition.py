"""Conditions on the figures of gaits, such as `speed > 0.1 and survived`.

The grammar is a part of Python's: and, or, not, comparisons, `in`, `is None`, + - * /, abs(),
numbers, strings and names, which may be dotted. A condition is compiled to one SQL expression with
parameters. It is never run as Python, and only the names of known columns enter the SQL.

The rules of SQL hold: comparisons with a missing value and divisions by zero are not true.
"""

from __future__ import annotations

import ast
import difflib
from collections.abc import Collection

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_CONDITION, MAX_CONDITION_NESTING

COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Eq: "=",
    ast.NotEq: "<>",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Is: "IS",
    ast.IsNot: "IS NOT",
    ast.In: "IN",
    ast.NotIn: "NOT IN",
}
ARITHMETIC: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*"}
ALLOWED = "use and, or, not, == != < <= > >=, in [..], is None, + - * /, abs(), numbers, 'strings'"


def compile_condition(
    text: str, columns: Collection[str], source: str
) -> tuple[str, list[int | float | str]]:
    """Compile a condition to an SQL expression and its parameters, in the order of the `?` in it.

    Args:
        text: the condition.
        columns: names that the condition may use.
        source: file or option that contains the condition, for messages.

    Raises:
        ConfigError: the text is not a condition, or uses a name that is not in `columns`.
    """
    if len(text) > MAX_CONDITION:
        raise ConfigError(source, f"longer than {MAX_CONDITION} characters")
    try:
        tree = ast.parse(text.strip(), mode="eval")
        compiler = _Compiler(text, columns, source)
        return compiler.sql(tree.body), compiler.parameters
    except (SyntaxError, ValueError) as error:
        problem = error.msg if isinstance(error, SyntaxError) else str(error)
        raise ConfigError(source, f"{text!r} is not a condition: {problem}; {ALLOWED}") from error
    except (RecursionError, MemoryError) as error:
        raise ConfigError(source, "nested too deeply") from error


def quoted(name: str) -> str:
    """Name of a column, quoted for SQL."""
    return '"' + name.replace('"', '""') + '"'


class _Compiler:
    """Compiler of one expression, which collects the parameters in the order of their `?`."""

    def __init__(self, text: str, columns: Collection[str], source: str) -> None:
        self.text, self.columns, self.source = text, columns, source
        self.parameters: list[int | float | str] = []
        self.depth = 0

    def sql(self, node: ast.expr) -> str:
        """Translate a part of the expression to SQL."""
        self.depth += 1
        if self.depth > MAX_CONDITION_NESTING:
            raise RecursionError
        text = self._part(node)
        self.depth -= 1
        return text

    def _part(self, node: ast.expr) -> str:
        match node:
            case ast.BoolOp(op, values):
                word = " AND " if isinstance(op, ast.And) else " OR "
                return f"({word.join(self.sql(value) for value in values)})"
            case ast.UnaryOp(ast.Not(), operand):
                return f"(NOT {self.sql(operand)})"
            case ast.UnaryOp(ast.USub(), operand):
                return f"(- {self.sql(operand)})"
            case ast.BinOp(left, ast.Div(), right):  # 1 / 2 is 0 in SQL
                return f"(1.0 * {self.sql(left)} / {self.sql(right)})"
            case ast.BinOp(left, op, right) if type(op) in ARITHMETIC:
                return f"({self.sql(left)} {ARITHMETIC[type(op)]} {self.sql(right)})"
            case ast.Compare(left, ops, rights):
                return self._comparison([left, *rights], ops)
            case ast.Call(ast.Name("abs"), [argument], []):
                return f"ABS({self.sql(argument)})"
            case ast.Name() | ast.Attribute():
                return self._column(node)
            case ast.Constant(value):
                return self._constant(value)
        raise self._refused(node)

    def _comparison(self, terms: list[ast.expr], ops: list[ast.cmpop]) -> str:
        parts = []
        for left, op, right in zip(terms, ops, terms[1:], strict=False):
            if type(op) not in COMPARISONS:
                raise self._refused(right)
            word, first = COMPARISONS[type(op)], self.sql(left)
            if isinstance(op, ast.In | ast.NotIn):
                if not isinstance(right, ast.List | ast.Tuple | ast.Set):
                    raise self._refused(right)
                second = f"({', '.join(self.sql(item) for item in right.elts)})"
            else:
                second = self.sql(right)
            parts.append(f"({first} {word} {second})")
        return f"({' AND '.join(parts)})"

    def _column(self, node: ast.expr) -> str:
        name = ast.unparse(node)
        if name not in self.columns:
            close = difflib.get_close_matches(name[:60], self.columns, n=1)
            hint = f"did you mean {close[0]!r}? " if close else ""
            known = ", ".join(sorted(self.columns))
            raise ConfigError(self.source, f"no column {name[:60]!r}; {hint}known columns: {known}")
        return quoted(name)

    def _constant(self, value: object) -> str:
        if value is None:
            return "NULL"
        if not isinstance(value, int | float | str):
            raise ValueError(f"{value!r} is neither a number nor a string")
        if isinstance(value, bool):
            value = int(value)
        elif isinstance(value, int) and abs(value) >= 2**63:
            raise ValueError("an integer is too large")
        self.parameters.append(value)
        return "?"

    def _refused(self, node: ast.AST) -> ValueError:
        part = ast.get_source_segment(self.text.strip(), node) or type(node).__name__
        return ValueError(f"{part[:60]!r} is not allowed")
