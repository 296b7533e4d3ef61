"""What accuracy costs in time, and what each effect changes and costs."""
