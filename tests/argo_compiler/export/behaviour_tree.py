"""Interpreter of the node types of BehaviorTree.CPP 4 that exported trees use.

Written from the library's documentation, on a virtual clock. Composite nodes with memory are
generators: they yield while something runs, and return True or False, or None if skipped.
"""

import xml.etree.ElementTree as ET

ATTRIBUTES = {
    "Sequence": {"name", "_skipIf"},
    "Fallback": {"name", "_skipIf"},
    "ForceSuccess": set(),
    "Repeat": {"num_cycles"},
    "RetryUntilSuccessful": {"num_attempts"},
    "Timeout": {"msec"},
    "Sleep": {"name", "msec"},
    "Script": {"code"},
    "ScriptCondition": {"code"},
}
DECORATORS = {"ForceSuccess", "Repeat", "RetryUntilSuccessful", "Timeout"}
LEAVES = {"Script", "ScriptCondition", "Sleep"}


def validate(text):
    """Return the tree's root node, and assert that the document has the library's format."""
    root = ET.fromstring(text)
    assert root.tag == "root"
    assert root.attrib["BTCPP_format"] == "4"
    tree, models = root
    assert (tree.tag, models.tag) == ("BehaviorTree", "TreeNodesModel")
    assert tree.attrib["ID"] == root.attrib["main_tree_to_execute"]
    ports = {}
    for model in models:
        assert model.tag == "Action"
        ports[model.attrib["ID"]] = {port.attrib["name"] for port in model}
        assert all(port.tag in ("input_port", "output_port") for port in model)
    assert len(tree) == 1
    for node in tree[0].iter():
        if node.tag in ports:
            assert set(node.attrib) <= ports[node.tag] | {"name"}
            assert len(node) == 0
        else:
            assert set(node.attrib) <= ATTRIBUTES[node.tag], node.tag
            if node.tag in LEAVES:
                assert len(node) == 0
            elif node.tag in DECORATORS:
                assert len(node) == 1
            else:
                assert len(node) > 0
    return tree[0]


class Interpreter:
    """Interpreter of one tree; holds its blackboard, its clock and its log of actions.

    `outcomes` yields the duration, value and failure of each action in turn. A value of 5 or more
    is abnormal; a failure with an even value is unreadable, one with an odd value unreachable.
    """

    def __init__(self, text, outcomes):
        self.root = validate(text)
        self.outcomes = outcomes
        self.board = {}
        self.now = 0.0
        self.log = []
        self.not_before = []
        self.result = None
        self.sleeps = None
        self.deadlines = []

    def run(self, steps):
        """Return the actions with their start times, and the outcome's number or None."""
        tree = self.node(self.root)
        try:
            next(tree)
            while len(self.log) < steps:
                # An action that started at a time-out's moment never ran, so it uses no outcome.
                if self.sleeps is None:
                    duration, *self.result = next(self.outcomes)
                    ends = max(self.now, self.not_before[-1]) + duration
                else:
                    ends = self.sleeps
                self.now = min([ends, *(deadline for deadline, _ in self.deadlines)])
                if ends == self.now:  # an action that ends exactly at a time-out counts as ended
                    next(tree)
                while due := [fired for deadline, fired in self.deadlines if deadline <= self.now]:
                    due[0].append(True)
                    if self.sleeps is None and self.log[-1][0] == self.now:
                        self.log.pop()
                    self.sleeps = None
                    next(tree)
        except StopIteration:
            return self.log[:steps], int(self.board["outcome"])
        return self.log[:steps], None

    def node(self, node):
        skip = node.get("_skipIf")
        if skip is not None and self.value(skip):
            return None
        return (yield from getattr(self, node.tag)(node))

    def Sequence(self, node):  # noqa: N802
        return self.in_turn(node, until=False)

    def Fallback(self, node):  # noqa: N802
        return self.in_turn(node, until=True)

    def in_turn(self, node, until):
        """Run the children one after the other, up to the first with the result `until`."""
        skipped = 0
        for child in node:
            result = yield from self.node(child)
            skipped += result is None
            if result is until:
                return until
        return None if skipped == len(node) else not until

    def ForceSuccess(self, node):  # noqa: N802
        result = yield from self.node(node[0])
        return None if result is None else True

    def Repeat(self, node):  # noqa: N802
        assert node.attrib["num_cycles"] == "-1"
        while True:
            result = yield from self.node(node[0])
            if not result:
                return result

    def RetryUntilSuccessful(self, node):  # noqa: N802
        for _ in range(int(node.attrib["num_attempts"])):
            result = yield from self.node(node[0])
            if result is not False:
                return result
        return False

    def Timeout(self, node):  # noqa: N802
        fired = []
        deadline = (self.now + int(node.attrib["msec"]) / 1000, fired)
        # The outer ones come first.
        self.deadlines.append(deadline)
        child = self.node(node[0])
        try:
            while True:
                try:
                    next(child)
                except StopIteration as end:
                    return end.value
                yield
                if fired:
                    return False
        finally:
            self.deadlines = [d for d in self.deadlines if d[1] is not fired]

    def Sleep(self, node):  # noqa: N802
        self.sleeps = self.now + int(node.attrib["msec"]) / 1000
        yield
        self.sleeps = None
        return True

    def Script(self, node):  # noqa: N802
        for statement in node.attrib["code"].split("; "):
            name, expression = statement.split(" := ")
            self.board[name] = self.value(expression)
        return True
        yield

    def ScriptCondition(self, node):  # noqa: N802
        return bool(self.value(node.attrib["code"]))
        yield

    def Clock(self, node):  # noqa: N802
        self.board[node.attrib["now"][1:-1]] = self.now
        return True
        yield

    def Measure(self, node):  # noqa: N802
        value, failed = yield from self.act(node)
        has_value = value is not None
        known = has_value and not failed
        outputs = {
            "value": value if known else 0.0,
            "known": float(known),
            "abnormal": float(known and value >= 5),
            "unreadable": float(failed and has_value and value % 2 == 0),
            "unreachable": float(failed and has_value and value % 2 == 1),
            "time": self.now,
        }
        for port, output in outputs.items():
            self.board[node.attrib[port][1:-1]] = output
        return not failed

    def DriveTo(self, node):  # noqa: N802
        _, failed = yield from self.act(node)
        return not failed

    def act(self, node):
        """Run an action, and return its value and whether it failed."""
        self.log.append((self.now, node.attrib["name"]))
        earliest = node.get("not_before")
        self.not_before.append(0 if earliest is None else self.board[earliest[1:-1]])
        yield
        return self.result

    def value(self, expression):
        if " ? " in expression:
            condition, rest = expression.split(" ? ")
            yes, no = rest.split(" : ")
            return self.value(yes if self.value(condition) else no)
        return eval(expression.replace("&&", "and"), {"__builtins__": {}}, dict(self.board))
