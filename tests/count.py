#!/usr/bin/env python3
"""Sums up meson's testlog.json files: "PASSED FAILED SKIPPED", each test of a cmocka group counted by itself.

Names what failed and why something was skipped on stderr."""
import json
import re
import sys

passed = failed = skipped = 0
for path in sys.argv[1:]:
    try:
        lines = open(path, encoding="utf-8", errors="replace").read().splitlines()
    except OSError:
        print(f"{path}: no test log", file=sys.stderr)
        failed += 1
        continue
    for line in lines:
        test = json.loads(line)
        text = (test.get("stdout") or "") + "\n" + (test.get("stderr") or "")
        good = test["result"] in ("OK", "EXPECTEDFAIL")
        groups = len(re.findall(r"\[ +RUN +\]", text))
        bad = sum(int(n) for n in re.findall(r"\[ +FAILED +\] .*?(\d+) test\(s\)", text))
        left_out = sum(int(n) for n in re.findall(r"\[ +SKIPPED +\] .*?(\d+) test\(s\)", text))
        if left_out or test["result"] == "SKIP":
            print(f"skipped: {test['name']}: {left_out or 1} tests", file=sys.stderr)
        if test["result"] == "SKIP":
            skipped += max(groups, 1)
        elif groups == 0:
            passed += good
            failed += not good
        else:
            if not good:
                bad = max(bad, 1)
            failed += bad
            skipped += left_out
            passed += max(groups - bad - left_out, 0)
        if not good:
            print(f"FAILED: {test['name']}: {test['result']}", file=sys.stderr)
print(passed, failed, skipped)
