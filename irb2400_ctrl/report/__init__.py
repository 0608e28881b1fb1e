"""What people look at: figures of plans and motions, self-contained HTML pages."""
