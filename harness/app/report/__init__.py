"""harness report and harness view: what a trace holds, shown again."""
