"""The estimators: functions of arrays that know no engine."""
