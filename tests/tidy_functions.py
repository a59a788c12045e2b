"""Where functions begin and end, for tests/tidy. Enough for sources laid out by clang-format."""

import re

_TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'
    r"(?<![0-9A-Za-z_])'(?:\\.|[^'\\\n])*'|^[ \t]*#(?:[^\n\\]|\\\n|\\.)*",
    re.DOTALL | re.MULTILINE)
_NOT_A_FUNCTION = re.compile(r"^(if|for|while|switch|catch|else|do|try|return|case|namespace|extern)\b")
_TYPE = re.compile(r"\b(class|struct|union|enum|namespace|concept)\b[^()]*$")
_LAMBDA = re.compile(r"\[[^\[\]]*\]\s*(\([^{}]*\))?\s*(mutable|noexcept|constexpr|->\s*[\w:<>&*, ]+|\s)*$")


def _blank(match):
    return re.sub(r"[^\n]", " ", match[0])


def without_comments(text):
    """The text with comments, literals and preprocessor lines blanked; lines keep their numbers."""
    return _TOKEN.sub(_blank, text)


def _name(head):
    match = re.search(r"([\w:~]+|operator\s*[^\s(]+)\s*\(", head)
    return match[1] if match else "(unnamed)"


def _opens_function(head, inside_function):
    """The name of the function whose head stands before a `{` (since the last `;`, `{`, `}`), or None."""
    head = head.strip()
    if _LAMBDA.search(head):
        return "lambda"
    if inside_function or "(" not in head or _NOT_A_FUNCTION.match(head) or _TYPE.search(head):
        return None
    if head.count("(") != head.count(")"):
        return None  # an argument in braces: the `{` stands inside a call
    if re.search(r"=\s*$", head) or re.match(r"^(class|struct|union|enum)\b", head):
        return None
    return _name(head)


def cpp_functions(text):
    """(name, first line, last line) of each function, method, test case and lambda with a body."""
    bare = without_comments(text)
    found, stack = [], []
    head_start = depth_round = 0
    for at, char in enumerate(bare):
        if char in "()":
            depth_round += 1 if char == "(" else -1
        if char == "{":
            inside = any(name for name, _, _ in stack)
            name = _opens_function(bare[head_start:at], inside)
            lead = len(bare[head_start:at]) - len(bare[head_start:at].lstrip())
            first = at if name == "lambda" else head_start + lead
            stack.append((name, bare.count("\n", 0, first) + 1, depth_round))
            depth_round = 0
            head_start = at + 1
        elif char == "}":
            if stack:
                name, first, depth_round = stack.pop()
                if name:
                    found.append((name, first, bare.count("\n", 0, at) + 1))
            if not depth_round:
                head_start = at + 1
        elif char == ";" and not depth_round:
            head_start = at + 1
    return found


def bash_functions(text):
    """(name, first line, last line) of functions written `name() {` or `name() (` that end in column one."""
    found, name, first = [], None, 0
    for number, line in enumerate(text.splitlines(), 1):
        match = re.match(r"^([\w-]+)\(\)\s*[{(]", line)
        if match:
            name, first = match[1], number
        if name and re.match(r"^[})]", line):
            found.append((name, first, number))
            name = None
    return found


def cmake_functions(text):
    """(name, first line, last line) of functions and macros."""
    found, name, first = [], None, 0
    for number, line in enumerate(text.splitlines(), 1):
        match = re.match(r"^\s*(?:function|macro)\((\w+)", line, re.IGNORECASE)
        if match:
            name, first = match[1], number
        if name and re.match(r"^\s*end(function|macro)\(", line, re.IGNORECASE):
            found.append((name, first, number))
            name = None
    return found
