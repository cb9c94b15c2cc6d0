"""The estimators: functions of arrays that know no engine. The entry is harness.estimate.every.estimate_all."""
