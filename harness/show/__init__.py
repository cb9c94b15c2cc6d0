"""What people see: the trace for the rerun viewer and the page for the browser. Imports core and results only."""
